"""The companion only guides, and the stand-ins of ArduCopter and PX4 land by themselves, each as far as it can."""

import pytest

from tests.scenarios.lockstep.guided import guided


@pytest.mark.slow
@pytest.mark.parametrize("speed_m_s", [0.0, 2.0])
def test_arducopters_own_landing_secures_the_drone_on_the_pad_that_it_is_told(speed_m_s: float) -> None:
    scored, to_contact_s = guided(speed_m_s, seed=1, firmware="ardupilot")
    assert scored.tier.value == "S3"
    assert scored.touchdown is not None
    assert scored.touchdown.horizontal_error_m < 0.25
    assert scored.touchdown.sink_rate_m_s < 0.6
    assert to_contact_s is not None
    assert to_contact_s < 25.0


@pytest.mark.slow
def test_px4s_own_landing_secures_the_drone_on_a_pad_that_stands() -> None:
    scored, to_contact_s = guided(0.0, seed=1, firmware="px4")
    assert scored.tier.value == "S3"
    assert scored.touchdown is not None
    assert to_contact_s is not None
    assert to_contact_s < 25.0


@pytest.mark.slow
def test_px4s_own_landing_trails_a_pad_that_drives() -> None:
    scored, to_contact_s = guided(1.0, seed=1, firmware="px4")
    assert scored.touchdown is None
    assert to_contact_s is None
