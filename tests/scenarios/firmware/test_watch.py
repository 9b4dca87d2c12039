"""The watch on a firmware's own simulation dates its truth by the simulation's clock, however late it is heard."""

import math
from dataclasses import dataclass

import pytest

from link.frames.geodesy import enu_from_geodetic
from link.mavlink.dialect import Message, mavlink
from scenarios.firmware.watch import FirmwareWatch
from tests.link.mavlink.fake_autopilot import MS, START_NS, UTC_AHEAD_NS, FakeAutopilot, S

SPEED_M_S = 8.0
_DEGREE_M = 111_200.0  # of latitude, about


def latitude_at_deg(boot_s: float) -> float:
    return 47.4 + SPEED_M_S * boot_s / _DEGREE_M


@dataclass
class Simulation(FakeAutopilot):
    """Flies north at a constant speed; its truth and an attitude leave it together."""

    firmware: int = mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA

    def message(self, message_id: int, t_ns: int) -> Message:
        boot_ms = self.boot_ns(t_ns) // MS
        if message_id == mavlink.MAVLINK_MSG_ID_ATTITUDE:
            return mavlink.MAVLink_attitude_message(boot_ms, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        if message_id == mavlink.MAVLINK_MSG_ID_GPS_RAW_INT:
            return mavlink.MAVLink_gps_raw_int_message(0, 3, 474_000_000, 85_000_000, 488_000, 0, 0, 0, 0, 10, 535_000)
        if message_id == mavlink.MAVLINK_MSG_ID_SIM_STATE:
            latitude_deg = latitude_at_deg(boot_ms * 1e-3)
            pose = (1.0, *(0.0,) * 12, latitude_deg, 8.5, 488.0, 0.0, 0.0, SPEED_M_S, 0.0, 0.0)
            return mavlink.MAVLink_sim_state_message(*pose, round(1e7 * latitude_deg), 85_000_000)
        return super().message(message_id, t_ns)


def fly(autopilot: Simulation, delay_ns: int) -> FirmwareWatch:
    """Let the watch hear every message `delay_ns` late; what it says arrives at once."""
    watch, under_way = FirmwareWatch(), list[tuple[int, bytes]]()
    for t_ns in range(START_NS, START_NS + 10 * S, 5 * MS):
        autopilot.tick(t_ns)
        under_way += [(t_ns + delay_ns, data) for data in autopilot.take_output()]
        while under_way and under_way[0][0] <= t_ns:
            watch.receive(under_way.pop(0)[1], t_ns)
        watch.session.poll(t_ns)
        for data in watch.session.take_output():
            autopilot.receive(data, t_ns)
    return watch


def ahead_m(watch: FirmwareWatch, autopilot: Simulation) -> float:
    """Return how far the newest truth is ahead of where the drone was at the time that it bears."""
    assert watch.drone is not None
    assert watch.datum is not None
    boot_s = autopilot.boot_ns(watch.drone.t_ns - UTC_AHEAD_NS) * 1e-9
    latitude_rad = math.radians(latitude_at_deg(boot_s))
    _, there_m, _ = enu_from_geodetic(watch.datum, latitude_rad, math.radians(8.5), watch.datum.altitude_m)
    return watch.drone.position_enu_m[1] - there_m


@pytest.mark.parametrize("delay_ns", [0, 40 * MS])
def test_truth_is_dated_by_the_attitude_sent_with_it(delay_ns: int) -> None:
    autopilot = Simulation()
    assert ahead_m(fly(autopilot, delay_ns), autopilot) == pytest.approx(0.0, abs=0.03)


def test_a_truth_without_its_fellow_is_dated_by_its_arrival() -> None:
    autopilot = Simulation(results={mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: ()})  # which is silence
    autopilot.intervals_ns = {mavlink.MAVLINK_MSG_ID_SIM_STATE: 10 * MS, mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: S}
    # The clocks are an exchange of 40 ms off by half of it.
    assert ahead_m(fly(autopilot, 40 * MS), autopilot) == pytest.approx(-0.020 * SPEED_M_S, abs=0.05)


def test_drone_stands_where_it_is_put() -> None:
    autopilot = Simulation()
    watch = fly(autopilot, 0)
    before, datum, place_m = watch.drone, watch.datum, (-70.0, 12.0, 0.5)
    assert before is not None
    assert datum is not None
    moved = watch.let_it_stand_at(place_m)
    assert watch.datum == moved
    assert watch.drone is None
    assert not watch.take_truths()
    there_m = enu_from_geodetic(moved, datum.latitude_rad, datum.longitude_rad, datum.altitude_m)
    assert there_m == pytest.approx(place_m, abs=1e-3)
