"""What the autopilot's messages tell of its sensors."""

import pytest

from companion.autopilots.driver import NO_AUTOPILOT
from companion.autopilots.sensor_reports import battery_share, with_sensor
from link.mavlink.clock_map import ClockMap, RoundTrip, with_round_trip, with_system_time
from link.mavlink.dialect import mavlink
from tests.companion.world import START_NS

BOOTED_NS = 50_000_000_000
_TRIP = RoundTrip(sent_ns=START_NS, received_ns=START_NS + 1_000_000, boot_ns=BOOTED_NS)
CLOCK = with_system_time(with_round_trip(ClockMap(), _TRIP), BOOTED_NS, START_NS)


@pytest.mark.parametrize(("percent", "share"), [(0, 0.0), (37, 0.37), (100, 1.0), (-1, None), (-128, None)])
def test_battery_tells_its_share_or_that_it_is_unknown(percent: int, share: float | None) -> None:
    told = mavlink.MAVLink_battery_status_message(0, 0, 0, 2500, [0] * 10, -1, -1, -1, percent)
    assert battery_share(told) == share


@pytest.mark.parametrize("percent", [101, 127])
def test_battery_of_more_than_all_tells_nothing(percent: int) -> None:
    told = mavlink.MAVLink_battery_status_message(0, 0, 0, 2500, [0] * 10, -1, -1, -1, percent)
    assert battery_share(told) is None


@pytest.mark.parametrize(("after_ms", "counts"), [(-1, False), (0, False), (-900, False), (20, True), (-1_100, True)])
def test_range_that_comes_late_is_passed_over_unless_the_clock_was_set_back(after_ms: int, *, counts: bool) -> None:
    view = NO_AUTOPILOT
    for boot_ms, distance_cm in ((50_000, 300), (50_000 + after_ms, 120)):
        told = mavlink.MAVLink_distance_sensor_message(boot_ms, 10, 3000, distance_cm, 0, 0, 25, 0)
        view = with_sensor(view, told, CLOCK, lambda _: None)
    assert view.range_down is not None
    assert (view.range_down.distance_m == pytest.approx(1.2)) is counts
