from math import hypot

import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.missions.fence import Area, is_allowed
from sim_autopilot.missions.items import FENCE
from sim_autopilot.safety.failures import NO_FAILURES, inject
from tests.sim_autopilot.pilot import HOLD, LAND, RTL, Pilot, command, px4, set_mode
from tests.sim_autopilot.planner import item, upload

pytestmark = pytest.mark.slow

ACCEPTED, UNSUPPORTED = 0, 3
INJECT = mavlink.MAV_CMD_INJECT_FAILURE
BATTERY, MOTOR, GPS, OFF = 100.0, 101.0, 4.0, 1.0
SQUARE = Area(corners=((0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)), radius_m=None, inclusion=True)
HOLE = Area(corners=((5.0, 5.0),), radius_m=2.0, inclusion=False)


def flying(**parameters: float) -> Pilot:
    pilot = Pilot(px4(parameters=parameters))
    pilot.take_off()
    return pilot


@pytest.mark.parametrize(
    ("x", "y", "allowed"), [(1.0, 2.0, True), (11.0, 2.0, False), (-0.1, 2.0, False), (5.5, 6.0, False)]
)
def test_a_fence_keeps_in_its_inclusions_and_out_of_its_exclusions(x: float, y: float, allowed: bool) -> None:
    assert is_allowed((SQUARE, HOLE), (x, y, 3.0)) == allowed
    assert is_allowed((), (x, y, 3.0))


def test_leaving_the_fence_stops_the_drone_at_its_edge() -> None:
    vertex = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
    corners = ((-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0))
    pilot = flying()
    corner_items = [item(i, vertex, (*c, 0.0), (4.0, 0.0, 0.0, 0.0), kind=FENCE) for i, c in enumerate(corners)]
    assert upload(pilot, corner_items, FENCE) == ACCEPTED
    pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, 4.0, 3.0))
    target = mavlink.MAVLink_command_int_message(
        1, 1, 0, mavlink.MAV_CMD_DO_REPOSITION, 0, 0, -1.0, 1.0, 0.0, 0.0, 524_733_000, 134_017_000 + 6000, 94.0
    )
    pilot.step(target)
    pilot.run(12.0)
    assert pilot.custom_mode() == HOLD
    assert 10.0 < pilot.position[0] < 15.0
    assert pilot.last("HEARTBEAT").system_status == mavlink.MAV_STATE_CRITICAL


def test_a_fence_that_terminates_stops_the_motors() -> None:
    pilot = flying(GF_ACTION=4.0)
    pilot.step(mavlink.MAVLink_param_set_message(1, 1, b"GF_MAX_VER_DIST", 4.0, mavlink.MAV_PARAM_TYPE_REAL32))
    pilot.step()
    assert not pilot.is_armed()


def test_a_battery_that_fails_lands_and_only_warns_where_it_is_to() -> None:
    warned, landing = flying(COM_LOW_BAT_ACT=0.0), flying()
    for pilot in (warned, landing):
        pilot.acknowledged(set_mode(4, 3))
        assert pilot.acknowledged(command(INJECT, BATTERY, OFF, 0.0)) == [ACCEPTED]
        pilot.run(0.5)
    assert warned.custom_mode() == HOLD
    assert landing.custom_mode() == LAND
    assert landing.last("SYS_STATUS").battery_remaining == 0


def test_a_critical_battery_returns_and_an_emergency_lands() -> None:
    pilot = Pilot(px4(endurance_s=30.0))
    pilot.take_off()
    pilot.acknowledged(set_mode(4, 3))
    pilot.run_until(lambda: pilot.custom_mode() == RTL, 30.0)
    assert pilot.t_s == pytest.approx(0.5 + 30.0 * (1.0 - 0.07), abs=0.6)  # BAT_CRIT_THR
    pilot.run_until(lambda: pilot.custom_mode() == LAND, 2.0)


def test_a_lost_ground_station_holds_and_then_returns() -> None:
    pilot = flying(NAV_DLL_ACT=2.0)
    pilot.acknowledged(set_mode(4, 3))
    pilot.step(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3))
    pilot.run(9.0)
    assert not pilot.node.memory.modes.failsafe
    pilot.run(3.0)
    assert (pilot.custom_mode(), pilot.node.memory.modes.failsafe) == (HOLD, True)
    pilot.run(5.0)
    assert pilot.custom_mode() == RTL


def test_failures_are_injected_only_where_the_parameter_lets_them_and_sensors_are_not_answered() -> None:
    without = Pilot(px4(parameters={"SYS_FAILURE_EN": 0.0}))
    assert without.acknowledged(command(INJECT, BATTERY, OFF, 0.0)) == [UNSUPPORTED]
    pilot = Pilot()
    assert pilot.acknowledged(command(INJECT, MOTOR, OFF, 2.0)) == [ACCEPTED]
    assert pilot.acknowledged(command(INJECT, GPS, OFF, 0.0)) == []
    stuck, wrong = float(mavlink.FAILURE_TYPE_STUCK), float(mavlink.FAILURE_TYPE_WRONG)
    assert pilot.acknowledged(command(INJECT, MOTOR, stuck, 0.0)) == [UNSUPPORTED]
    assert pilot.acknowledged(command(INJECT, BATTERY, stuck, 0.0)) == []
    assert pilot.acknowledged(command(INJECT, MOTOR, wrong, 0.0)) == [ACCEPTED]


def test_a_failed_motor_brings_the_drone_down() -> None:
    pilot = flying()
    pilot.acknowledged(command(INJECT, MOTOR, OFF, 1.0))
    pilot.run(4.0)
    assert pilot.position[2] < 1.0
    assert hypot(*pilot.position) < 100.0


def test_an_injection_that_is_no_such_thing_changes_nothing() -> None:
    for unit, kind, instance in ((int(MOTOR), 2, 0), (int(MOTOR), 1, 9), (0, 1, 0), (-1, -1, -1)):
        assert inject(NO_FAILURES, unit, kind, instance) is None


def told_low(pilot: Pilot) -> list[Message]:
    return [m for m in pilot.all("BATTERY_STATUS") if m.charge_state != mavlink.MAV_BATTERY_CHARGE_STATE_OK]


def test_the_battery_tells_that_it_is_low() -> None:
    pilot = Pilot(px4(endurance_s=20.0))
    pilot.take_off()
    pilot.acknowledged(set_mode(4, 3))
    assert not told_low(pilot)
    pilot.run(21.0 - pilot.t_s)
    assert told_low(pilot)
