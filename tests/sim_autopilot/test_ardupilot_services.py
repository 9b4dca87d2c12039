from collections.abc import Callable
from math import cos, degrees, hypot, radians, sin

import pytest

from link.frames.rotations import roll_pitch_yaw_of
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.modes import Event, Mode
from sim_autopilot.core.parameters import default_values
from sim_autopilot.core.settings import FailsafeSettings
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.firmware.ardupilot.failsafes import failsafe_settings
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.safety.failsafes import NOTHING_NOTICED, Watch, watch_battery, watch_fence, watch_station
from tests.sim_autopilot.copter import ALT_HOLD, GUIDED, LOITER, RTL, ardupilot, copter_in_the_air, mode
from tests.sim_autopilot.pilot import Pilot, arm
from tests.sim_autopilot.planner import EAST_M, LATITUDE, LONGITUDE, NORTH_M

pytestmark = pytest.mark.slow

HOME = (0.0, 0.0, 0.1)


def channels(roll: int = 1500, pitch: int = 1500, throttle: int = 1500) -> Callable[[float], Message]:
    message = mavlink.MAVLink_rc_channels_override_message(1, 1, roll, pitch, throttle, 1500, 0, 0, 0, 0)
    return lambda _t: message


def flying(config: AutopilotConfig | None = None, height_m: float = 10.0) -> Pilot:
    return copter_in_the_air(config, height_m)


def settings(**parameters: float) -> FailsafeSettings:
    return failsafe_settings(default_values(ARDUPILOT.parameters.table, parameters))


def test_loiter_flies_the_sticks_velocity_and_stops_when_they_are_centred() -> None:
    pilot = flying()
    pilot.run(0.1, channels())
    pilot.step(mode(LOITER))
    pilot.run(5.0, channels(pitch=1260))
    assert hypot(*pilot.node.state.velocity_enu_m_s[:2]) == pytest.approx(12.5 * (0.48 - 0.04) / 0.96, abs=0.3)
    pilot.run(7.0, channels())
    assert hypot(*pilot.node.state.velocity_enu_m_s[:2]) < 0.1
    assert pilot.position[2] == pytest.approx(10.0, abs=0.3)


def test_alt_hold_leans_by_the_sticks_and_keeps_its_height() -> None:
    pilot = flying()
    pilot.run(0.1, channels())
    pilot.step(mode(ALT_HOLD))
    pilot.run(2.0, channels(roll=1650))
    roll, _, _ = roll_pitch_yaw_of(pilot.node.state.orientation_wxyz.tolist())
    assert degrees(roll) == pytest.approx(0.3 * 30.0, abs=1.0)  # ANGLE_MAX
    assert pilot.position[2] == pytest.approx(10.0, abs=0.3)


def test_without_a_pilot_the_receivers_throttle_is_down_and_loiter_descends() -> None:
    pilot = flying(height_m=8.0)
    pilot.step(mode(LOITER))
    pilot.run(2.2)
    assert pilot.node.state.velocity_enu_m_s[2] == pytest.approx(-2.5, abs=0.3)  # PILOT_SPEED_UP
    assert pilot.node.memory.modes.mode is Mode.POSITION


def test_throttle_above_the_middle_takes_off_in_loiter() -> None:
    pilot = Pilot(ardupilot())
    pilot.run(0.1, channels(throttle=1000))
    pilot.step(mode(LOITER), arm())
    pilot.run(1.0, channels(throttle=1000))
    assert pilot.position[2] < 0.2
    pilot.run(4.0, channels(throttle=1800))
    assert pilot.position[2] > 1.0


def attitude(roll_rad: float = 0.0, thrust: float = 0.5, mask: int = 7) -> Message:
    q = (cos(roll_rad / 2.0), sin(roll_rad / 2.0), 0.0, 0.0)
    return mavlink.MAVLink_set_attitude_target_message(0, 1, 1, mask, q, 0.0, 0.0, 0.0, thrust)


def test_an_attitude_is_flown_in_guided_at_the_height_where_it_began() -> None:
    pilot = flying()
    pilot.run(2.0, lambda _t: attitude(radians(10.0)))
    roll, _, _ = roll_pitch_yaw_of(pilot.node.state.orientation_wxyz.tolist())
    assert degrees(roll) == pytest.approx(10.0, abs=0.6)
    assert pilot.position[2] == pytest.approx(10.0, abs=0.2)


def test_the_thrust_of_an_attitude_is_a_climb_rate_unless_guid_options_say_thrust() -> None:
    pilot = flying()
    pilot.run(3.0, lambda _t: attitude(thrust=0.8))
    assert pilot.node.state.velocity_enu_m_s[2] == pytest.approx(0.6 * 2.5, abs=0.1)  # WPNAV_SPEED_UP
    by_thrust = flying(ardupilot(parameters={"GUID_OPTIONS": 8.0}))
    by_thrust.run(1.0, lambda _t: attitude(thrust=0.2))
    assert by_thrust.node.state.velocity_enu_m_s[2] < -2.0  # far less than MOT_THST_HOVER


def test_a_silent_or_wrong_attitude_levels_the_drone() -> None:
    pilot = flying()
    pilot.run(0.5, lambda _t: attitude(radians(10.0)))
    pilot.run(4.0)
    roll, _, _ = roll_pitch_yaw_of(pilot.node.state.orientation_wxyz.tolist())
    assert abs(degrees(roll)) < 1.0
    pilot.step(attitude(mask=7 | 64))
    assert pilot.node.memory.course.guided.attitude is None


@pytest.mark.parametrize(("frame", "altitude_m"), [(5, 97.0), (6, 8.0), (11, 8.0)])
def test_a_global_setpoint_is_flown_in_guided_in_every_frame(frame: int, altitude_m: float) -> None:
    pilot = flying()
    x, y = round(LATITUDE + 4.0 * NORTH_M), round(LONGITUDE + 3.0 * EAST_M)
    message = mavlink.MAVLink_set_position_target_global_int_message(
        0, 1, 1, frame, 0b1101_1111_1000, x, y, altitude_m, 0, 0, 0, 0, 0, 0, 0, 0
    )
    pilot.run(10.0, lambda _t: message)
    assert pilot.position == pytest.approx((3.0, 4.0, 8.1), abs=0.2)


@pytest.mark.parametrize(("action", "event"), [(1, Event.FAILSAFE_RTL), (5, Event.FAILSAFE_LAND), (0, None)])
def test_a_lost_ground_station_acts_at_once_as_fs_gcs_enable_says(action: float, event: Event | None) -> None:
    rules = settings(FS_GCS_ENABLE=action)
    watch, soon = watch_station(Watch(station_ns=0), round(4.9e9), rules)
    assert soon is None
    watch, late = watch_station(watch, round(5.1e9), rules)
    assert late is event
    assert watch_station(watch, round(20e9), rules)[1] is None


def test_only_heartbeats_of_sysid_mygcs_count() -> None:
    pilot = flying(ardupilot(parameters={"FS_GCS_ENABLE": 1.0, "SYSID_MYGCS": 7.0}), height_m=3.0)
    pilot.step(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3))
    assert pilot.node.memory.safety.watch.station_ns is None
    own = flying(ardupilot(parameters={"FS_GCS_ENABLE": 1.0, "SYSID_MYGCS": 1.0}), height_m=3.0)
    own.step(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_ONBOARD_CONTROLLER, 8, 0, 0, 4, 3))
    own.run(5.2)
    assert own.node.memory.modes.mode is Mode.RTL
    assert own.node.memory.modes.failsafe


def test_the_battery_acts_at_its_voltage_and_at_its_charge() -> None:
    by_voltage = settings(BATT_LOW_VOLT=10.71, BATT_FS_LOW_ACT=2)
    assert watch_battery(NOTHING_NOTICED, 0.31, by_voltage)[1] is None
    assert watch_battery(NOTHING_NOTICED, 0.29, by_voltage)[1] is Event.FAILSAFE_RTL
    by_charge = settings(BATT_LOW_MAH=1650, BATT_CRT_MAH=330, BATT_FS_CRT_ACT=1)
    watch, event = watch_battery(NOTHING_NOTICED, 0.49, by_charge)
    assert (watch.level, event) == (1, None)
    assert watch_battery(watch, 0.09, by_charge)[1] is Event.FAILSAFE_LAND
    assert watch_battery(NOTHING_NOTICED, 0.0, settings(BATT_MONITOR=0))[1] is None


def test_simulated_wind_and_voltage_are_changed_in_flight() -> None:
    pilot = flying()
    for name, value in ((b"SIM_WIND_SPD", 6.0), (b"SIM_WIND_DIR", 90.0), (b"BATT_FS_LOW_ACT", 2.0)):
        pilot.step(mavlink.MAVLink_param_set_message(1, 1, name, value, mavlink.MAV_PARAM_TYPE_REAL32))
    pilot.run(4.0)
    roll, pitch, _ = roll_pitch_yaw_of(pilot.node.state.orientation_wxyz.tolist())
    assert pilot.node.memory.world.wind_enu_m_s == pytest.approx((-6.0, 0.0, 0.0), abs=1e-9)  # out of the east
    assert degrees(roll) > 1.0  # its nose to the north, it leans into it
    assert abs(degrees(pitch)) < 0.5
    pilot.step(mavlink.MAVLink_param_set_message(1, 1, b"SIM_BATT_VOLTAGE", 10.4, mavlink.MAV_PARAM_TYPE_REAL32))
    pilot.step()
    assert pilot.node.memory.modes.mode is Mode.RTL


@pytest.mark.parametrize(
    ("kinds", "place", "left"),
    [(1, (0.0, 0.0, 100.3), True), (2, (290.0, 90.0, 5.0), True), (2, (0.0, 0.0, 500.0), False), (7, HOME, False)],
)
def test_the_fences_of_fence_type_are_kept(kinds: float, place: tuple[float, float, float], left: bool) -> None:
    rules = settings(FENCE_ENABLE=1, FENCE_TYPE=kinds)
    assert (watch_fence(NOTHING_NOTICED, (), place, HOME, rules)[1] is Event.FAILSAFE_RTL) == left
    assert watch_fence(NOTHING_NOTICED, (), place, HOME, settings(FENCE_TYPE=kinds))[1] is None


def test_a_return_climbs_into_its_cone_only_and_stays_over_home() -> None:
    pilot = flying(ardupilot(parameters={"RTL_ALT": 3000.0}), height_m=5.0)
    out = mavlink.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, 1, 0b1101_1111_1000, 0.0, 3.0, -5.0, 0, 0, 0, 0, 0, 0, 0, 0
    )
    pilot.run(6.0, lambda _t: out)
    distance_m = hypot(*pilot.position[:2])
    pilot.step(mode(RTL))
    began_s, highest_m = pilot.t_s, 0.0
    while pilot.t_s - began_s < 12.0:
        pilot.run(0.1)
        highest_m = max(highest_m, float(pilot.position[2]))
    assert highest_m == pytest.approx(3.0 * distance_m, abs=0.5)  # RTL_CONE_SLOPE
    assert pilot.position[2] > 0.7 * highest_m  # RTL_LOIT_TIME
    assert pilot.node.memory.modes.mode is Mode.RTL
    assert pilot.node.memory.modes.intended is not Mode.OFFBOARD
    assert ARDUPILOT.modes.codes[Mode.OFFBOARD].custom_mode == GUIDED
