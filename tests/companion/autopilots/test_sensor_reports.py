"""What the autopilot's messages tell of its sensors."""

import pytest

from companion.autopilots.sensor_reports import battery_share
from link.mavlink.dialect import mavlink


@pytest.mark.parametrize(("percent", "share"), [(0, 0.0), (37, 0.37), (100, 1.0), (-1, None), (-128, None)])
def test_battery_tells_its_share_or_that_it_is_unknown(percent: int, share: float | None) -> None:
    told = mavlink.MAVLink_battery_status_message(0, 0, 0, 2500, [0] * 10, -1, -1, -1, percent)
    assert battery_share(told) == share


@pytest.mark.parametrize("percent", [101, 127])
def test_battery_of_more_than_all_tells_nothing(percent: int) -> None:
    told = mavlink.MAVLink_battery_status_message(0, 0, 0, 2500, [0] * 10, -1, -1, -1, percent)
    assert battery_share(told) is None
