"""More samples than any sensor makes: late ones would each have the filter run anew over all of them."""

import pytest

from tests.companion.peer import Setup


@pytest.mark.slow
def test_samples_beyond_what_any_sensor_makes_are_refused_and_told_and_the_next_second_is_heard_again() -> None:
    setup = Setup()
    setup.run(3.0)
    before = setup.node.bad_payloads
    for number in range(1000):
        setup.fix(late_s=0.001 * (number % 700))
    assert setup.node.bad_payloads - before == 600
    assert "more than 400 times in a second" in setup.node.vehicle.refused_lately()
    setup.run(1.1)
    refused = setup.node.bad_payloads
    setup.fix()
    assert setup.node.bad_payloads == refused
