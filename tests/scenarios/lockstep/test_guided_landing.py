"""The companion only guides, and the stand-in of ArduCopter lands by itself."""

import pytest

from tests.scenarios.lockstep.guided import guided


@pytest.mark.slow
@pytest.mark.parametrize("speed_m_s", [0.0, 2.0])
def test_arducopters_own_landing_secures_the_drone_on_the_pad_that_it_is_told(speed_m_s: float) -> None:
    scored, to_contact_s = guided(speed_m_s, seed=1)
    assert scored.tier.value == "S3"
    assert scored.touchdown is not None
    assert scored.touchdown.horizontal_error_m < 0.25
    assert scored.touchdown.sink_rate_m_s < 0.6
    assert to_contact_s is not None
    assert to_contact_s < 25.0
