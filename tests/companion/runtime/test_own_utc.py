"""UTC by the computer's date, for an autopilot whose clock is off."""

import pytest

from tests.companion.peer import TICK_NS, Setup
from tests.companion.world import configured
from tests.link.mavlink.fake_autopilot import UTC_AHEAD_NS


@pytest.mark.parametrize(("utc", "ahead_ns"), [("autopilot", UTC_AHEAD_NS), ("computer", 0)])
def test_utc_is_what_the_configuration_says(utc: str, ahead_ns: int) -> None:
    setup = Setup(config=configured({"autopilot": {"utc": utc}}))
    for _ in range(3):
        setup.run(1.5)
        clock = setup.node.autopilot.session.clock
        assert clock.is_utc_known
        assert clock.local_to_utc_ns(setup.t_ns) - setup.t_ns == pytest.approx(ahead_ns, abs=TICK_NS)
    assert setup.node.is_ready_to_start()
