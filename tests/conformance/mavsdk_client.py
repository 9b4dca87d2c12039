"""MAVSDK as a client: each case is a function, and what it finds is printed as `CASE name=ok` or what failed.

A program of its own, since the library keeps threads and prints. `python -m tests.conformance.mavsdk_client URL px4`.
"""

import sys
import traceback
from collections.abc import Callable
from math import hypot, nan
from types import SimpleNamespace

from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.action import Action, ActionError, ActionResult, OrbitYawBehavior
from mavsdk.plugins.failure import Failure, FailureError, FailureResult, FailureType, FailureUnit
from mavsdk.plugins.geofence import Circle, FenceType, Geofence, GeofenceData, Point, Polygon
from mavsdk.plugins.info import Info
from mavsdk.plugins.manual_control import ManualControl
from mavsdk.plugins.mission import Mission, MissionItem, MissionPlan
from mavsdk.plugins.mission_raw import MissionItem as RawItem
from mavsdk.plugins.mission_raw import MissionRaw
from mavsdk.plugins.offboard import (
    AccelerationNed,
    Attitude,
    AttitudeRate,
    Offboard,
    PositionGlobalYaw,
    PositionNedYaw,
    VelocityBodyYawspeed,
    VelocityNedYaw,
)
from mavsdk.plugins.param import Param, ParamError, ParamResult
from mavsdk.plugins.telemetry import FlightMode, LandedState, Telemetry

from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.firmware.px4.px4 import PX4
from tests.conformance.programs import wait

NORTH_DEG = 1.0 / 111_250.0
"""A metre northwards."""
PLUGINS = (Action, Failure, Geofence, Info, ManualControl, Mission, MissionRaw, Offboard, Param, Telemetry)
STREAMS = (
    "position",
    "position_velocity_ned",
    "attitude_euler",
    "landed_state",
    "in_air",
    "velocity_ned",
    "home",
    "health",
)

Case = Callable[[SimpleNamespace], None]


def connected(url: str, firmware: str) -> SimpleNamespace:
    """Return the plugins of the first autopilot, by their names in lower case."""
    mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    mavsdk.add_any_connection(url)
    system = mavsdk.first_autopilot(30.0)
    drone = SimpleNamespace(mavsdk=mavsdk, guided=firmware == "ardupilot")
    for plugin in PLUGINS:
        setattr(drone, plugin.__name__.lower(), plugin(system))
    for stream in STREAMS:  # ArduCopter streams nothing unasked
        getattr(drone.telemetry, f"set_rate_{stream}")(10.0)
    wait(lambda: drone.telemetry.home().latitude_deg == drone.telemetry.home().latitude_deg)
    return drone


def refusal(function: Callable[[], object], error: type[Exception]) -> object:
    """Return the result with which a call is refused, None where it is not."""
    try:
        function()
    except error as refused:
        return refused.args[0] if not hasattr(refused, "result") else refused.result
    return None


def ready(drone: SimpleNamespace) -> None:
    """Be in a mode that arms."""
    if drone.guided:
        refusal(drone.action.takeoff, ActionError)  # is refused, and leaves it in GUIDED
    else:
        drone.action.hold()
    wait(lambda: drone.telemetry.flight_mode() in {FlightMode.HOLD, FlightMode.OFFBOARD})


def up(drone: SimpleNamespace, height_m: float = 5.0) -> None:
    """Hover."""
    drone.action.set_takeoff_altitude(height_m)
    ready(drone)
    drone.action.arm()
    drone.action.takeoff()
    wait(lambda: drone.telemetry.position().relative_altitude_m > height_m - 0.5)
    wait(lambda: abs(drone.telemetry.velocity_ned().down_m_s) < 0.1)


def down(drone: SimpleNamespace) -> None:
    """Land, and wait for the motors to stop."""
    drone.action.land()
    wait(lambda: not drone.telemetry.armed())
    ready(drone)


def north_m(drone: SimpleNamespace) -> float:
    """Return how far the drone is north of home."""
    return float((drone.telemetry.position().latitude_deg - drone.telemetry.home().latitude_deg) / NORTH_DEG)


def is_healthy(drone: SimpleNamespace) -> None:
    wait(lambda: drone.telemetry.health().is_armable and drone.telemetry.health().is_global_position_ok)
    assert drone.telemetry.health_all_ok() or drone.guided


def tells_what_it_is(drone: SimpleNamespace) -> None:
    version = drone.info.get_version()
    assert (version.flight_sw_major, version.flight_sw_minor) == ((4, 6) if drone.guided else (1, 17))


def streams_at_the_rates_asked_for(drone: SimpleNamespace) -> None:
    telemetry = drone.telemetry
    telemetry.set_rate_position(20.0)
    telemetry.set_rate_attitude_euler(10.0)
    heard = {"position": 0, "attitude_euler": 0}

    def counting(name: str) -> Callable[[object, object], None]:
        def count(_value: object, _user_data: object) -> None:
            heard[name] += 1

        return count

    handles = {name: getattr(telemetry, f"subscribe_{name}")(counting(name)) for name in heard}
    wait(lambda: heard["attitude_euler"] >= 60)
    told = dict(heard)
    for name, handle in handles.items():
        getattr(telemetry, f"unsubscribe_{name}")(handle)
    telemetry.set_rate_position(10.0)
    assert 1.8 < told["position"] / told["attitude_euler"] < 2.2, told


def lists_every_parameter(drone: SimpleNamespace) -> None:
    listed = drone.param.get_all_params()
    firmware = ARDUPILOT if drone.guided else PX4
    assert len(listed.int_params) + len(listed.float_params) == len(firmware.parameters.table)


def sets_parameters(drone: SimpleNamespace) -> None:
    name = "WPNAV_SPEED" if drone.guided else "MPC_XY_CRUISE"
    before = drone.param.get_param_float(name)
    drone.param.set_param_float(name, before + 1.0)
    assert drone.param.get_param_float(name) == before + 1.0
    drone.param.set_param_float(name, before)
    assert refusal(lambda: drone.param.get_param_int("NO_SUCH_NAME"), ParamError) == ParamResult.TIMEOUT


def arms_and_disarms(drone: SimpleNamespace) -> None:
    ready(drone)
    drone.action.arm()
    wait(drone.telemetry.armed)
    drone.action.disarm()
    wait(lambda: not drone.telemetry.armed())


def takes_off_and_lands(drone: SimpleNamespace) -> None:
    up(drone, 4.0)
    assert drone.telemetry.landed_state() in {LandedState.IN_AIR, LandedState.TAKING_OFF}
    refused = refusal(drone.action.disarm, ActionError)
    assert refused == (ActionResult.FAILED if drone.guided else ActionResult.COMMAND_DENIED), refused
    down(drone)
    assert drone.telemetry.landed_state() == LandedState.ON_GROUND


def goes_to_a_place_and_returns(drone: SimpleNamespace) -> None:
    drone.action.set_return_to_launch_altitude(8.0)
    up(drone)
    home = drone.telemetry.home()
    drone.action.goto_location(
        home.latitude_deg + 15.0 * NORTH_DEG, home.longitude_deg, home.absolute_altitude_m + 7.0, 0.0
    )
    wait(lambda: abs(north_m(drone) - 15.0) < 0.7)
    drone.action.return_to_launch()
    wait(lambda: drone.telemetry.flight_mode() == FlightMode.RETURN_TO_LAUNCH)
    wait(lambda: not drone.telemetry.armed())
    assert abs(north_m(drone)) < 1.0
    ready(drone)


def circles_where_it_has_such_a_mode(drone: SimpleNamespace) -> None:
    up(drone)
    home = drone.telemetry.home()

    def orbit() -> None:
        facing = OrbitYawBehavior.HOLD_FRONT_TO_CIRCLE_CENTER
        height_m = home.absolute_altitude_m + 5.0
        drone.action.do_orbit(6.0, 3.0, facing, home.latitude_deg, home.longitude_deg, height_m)

    if drone.guided:
        assert refusal(orbit, ActionError) == ActionResult.UNSUPPORTED
    else:
        orbit()
        wait(lambda: abs(hypot(*_velocity(drone)[:2]) - 3.0) < 0.3)
    down(drone)


def _velocity(drone: SimpleNamespace) -> tuple[float, float, float]:
    v = drone.telemetry.position_velocity_ned().velocity
    return (v.north_m_s, v.east_m_s, v.down_m_s)


def _near(drone: SimpleNamespace, north: float, east: float, down_m: float) -> bool:
    p = drone.telemetry.position_velocity_ned().position
    return hypot(p.north_m - north, p.east_m - east, p.down_m - down_m) < 0.7


def _close(drone: SimpleNamespace, wanted: tuple[float, float, float]) -> bool:
    return hypot(*(v - w for v, w in zip(_velocity(drone), wanted, strict=True))) < 0.4


def flies_every_kind_of_setpoint(drone: SimpleNamespace) -> None:
    offboard = drone.offboard
    up(drone)
    here = drone.telemetry.position_velocity_ned().position
    n, e, d = here.north_m, here.east_m, here.down_m
    still = VelocityNedYaw(0.0, 0.0, 0.0, 0.0)
    offboard.set_position_ned(PositionNedYaw(n, e, d, 0.0))
    offboard.start()
    wait(lambda: drone.telemetry.flight_mode() == FlightMode.OFFBOARD)
    offboard.set_position_ned(PositionNedYaw(n + 3.0, e + 2.0, d - 1.0, 90.0))
    wait(lambda: _near(drone, n + 3.0, e + 2.0, d - 1.0))
    offboard.set_velocity_ned(VelocityNedYaw(0.0, 2.0, -0.3, 0.0))
    wait(lambda: _close(drone, (0.0, 2.0, -0.3)))
    offboard.set_velocity_body(VelocityBodyYawspeed(1.0, 0.0, 0.0, 30.0))
    wait(lambda: abs(drone.telemetry.attitude_angular_velocity_body().yaw_rad_s - 0.52) < 0.1)
    offboard.set_position_velocity_ned(PositionNedYaw(n, e, d, 0.0), still)
    wait(lambda: _near(drone, n, e, d))
    offboard.set_position_velocity_acceleration_ned(
        PositionNedYaw(n + 2.0, e, d, 0.0), still, AccelerationNed(0.0, 0.0, 0.0)
    )
    wait(lambda: _near(drone, n + 2.0, e, d))
    offboard.set_acceleration_ned(AccelerationNed(1.0, 0.0, 0.0))
    wait(lambda: _velocity(drone)[0] > 1.0)
    home, above = drone.telemetry.home(), PositionGlobalYaw.AltitudeType.REL_HOME
    offboard.set_position_global(PositionGlobalYaw(home.latitude_deg, home.longitude_deg, 6.0, 0.0, above))
    wait(lambda: abs(north_m(drone)) < 0.7 and abs(drone.telemetry.position().relative_altitude_m - 6.0) < 0.7)
    offboard.set_attitude(Attitude(6.0, 0.0, 0.0, 0.5))
    wait(lambda: abs(drone.telemetry.attitude_euler().roll_deg - 6.0) < 1.5)
    offboard.set_attitude_rate(AttitudeRate(0.0, 0.0, 20.0, 0.5))
    wait(lambda: abs(drone.telemetry.attitude_angular_velocity_body().yaw_rad_s - 0.35) < 0.1)
    offboard.set_position_ned(PositionNedYaw(n, e, d, 0.0))
    wait(lambda: _near(drone, n, e, d))
    offboard.stop()
    down(drone)


def _item(north: float, height_m: float, home: object) -> MissionItem:
    place = (home.latitude_deg + north * NORTH_DEG, home.longitude_deg)  # type: ignore[attr-defined]  # it has no types
    nothing = (nan, nan, MissionItem.CameraAction.NONE, nan, nan, 1.0, nan, nan, MissionItem.VehicleAction.NONE)
    return MissionItem(*place, height_m, 5.0, True, *nothing)


def flies_a_mission(drone: SimpleNamespace) -> None:
    if drone.guided:
        return  # MAVSDK sends it items without a heading, which ArduCopter refuses
    mission, home = drone.mission, drone.telemetry.home()
    drone.action.set_return_to_launch_altitude(8.0)
    mission.set_return_to_launch_after_mission(True)
    mission.upload_mission(MissionPlan([_item(north, 6.0, home) for north in (0.0, 10.0, 20.0)]))
    assert len(mission.download_mission().mission_items) == 3
    ready(drone)
    drone.action.arm()
    mission.start_mission()
    wait(lambda: mission.mission_progress().current == 1)
    mission.pause_mission()
    wait(lambda: drone.telemetry.flight_mode() == FlightMode.HOLD)
    mission.set_current_mission_item(2)
    mission.start_mission()
    wait(mission.is_mission_finished)
    wait(lambda: not drone.telemetry.armed())
    mission.clear_mission()
    ready(drone)


def keeps_a_raw_mission(drone: SimpleNamespace) -> None:
    home, raw = drone.telemetry.home(), drone.missionraw
    x, y = round(home.latitude_deg * 1e7), round(home.longitude_deg * 1e7)
    commands = (16, 22, 16, 178, 21)
    items = [
        RawItem(seq, 2 if command == 178 else 6, command, int(seq == 0), 1, 1.0, 3.0, 0.0, 0.0, x, y, 5.0, 0)
        for seq, command in enumerate(commands)
    ]
    raw.upload_mission(items)
    assert tuple(item.command for item in raw.download_mission()) == commands
    raw.clear_mission()
    assert len(raw.download_mission()) <= 1


def keeps_a_fence(drone: SimpleNamespace) -> None:
    home = drone.telemetry.home()
    corners = [
        Point(home.latitude_deg + a * 1e-3, home.longitude_deg + b * 1e-3) for a, b in ((-1, -1), (1, -1), (1, 2))
    ]
    circle = Circle(Point(home.latitude_deg + 5e-4, home.longitude_deg), 5.0, FenceType.EXCLUSION)
    drone.geofence.upload_geofence(GeofenceData([Polygon(corners, FenceType.INCLUSION)], [circle]))
    kept = drone.geofence.download_geofence()
    assert (len(kept.polygons), len(kept.polygons[0].points), len(kept.circles)) == (1, 3, 1)
    drone.geofence.clear_geofence()
    assert not drone.geofence.download_geofence().polygons


def injects_failures_where_the_firmware_does(drone: SimpleNamespace) -> None:
    def fail(kind: FailureType) -> None:
        drone.failure.inject(FailureUnit.SYSTEM_MOTOR, kind, 1)

    if drone.guided:
        assert refusal(lambda: fail(FailureType.OFF), FailureError) == FailureResult.UNSUPPORTED
    else:
        fail(FailureType.OFF)
        fail(FailureType.OK)


def flies_by_sticks(drone: SimpleNamespace) -> None:
    if drone.guided:
        return  # ArduCopter hears sticks of SYSID_MYGCS only, which MAVSDK is not
    sticks = drone.manualcontrol
    up(drone)
    sticks.set_manual_control_input(0.0, 0.0, 0.5, 0.0)
    sticks.start_position_control()

    def pushed() -> bool:
        sticks.set_manual_control_input(0.5, 0.0, 0.5, 0.0)
        if drone.telemetry.flight_mode() != FlightMode.POSCTL:
            sticks.start_position_control()  # 0.1 s without sticks here are 0.5 s there: PX4 takes them for lost
        return hypot(*_velocity(drone)) > 2.0

    wait(pushed)
    assert drone.telemetry.flight_mode() == FlightMode.POSCTL
    down(drone)


def stops_its_motors_by_force_and_refuses_to_reboot(drone: SimpleNamespace) -> None:
    up(drone, 3.0)
    refused = refusal(drone.action.reboot, ActionError)
    assert refused == (ActionResult.FAILED if drone.guided else ActionResult.COMMAND_DENIED), refused
    drone.action.kill()
    wait(lambda: not drone.telemetry.armed())
    wait(lambda: drone.telemetry.position().relative_altitude_m < 0.5 and hypot(*_velocity(drone)) < 0.1)
    ready(drone)
    drone.action.arm()
    drone.action.disarm()


CASES: tuple[Case, ...] = (
    is_healthy,
    tells_what_it_is,
    streams_at_the_rates_asked_for,
    lists_every_parameter,
    sets_parameters,
    arms_and_disarms,
    takes_off_and_lands,
    goes_to_a_place_and_returns,
    circles_where_it_has_such_a_mode,
    flies_every_kind_of_setpoint,
    flies_a_mission,
    keeps_a_raw_mission,
    keeps_a_fence,
    injects_failures_where_the_firmware_does,
    flies_by_sticks,
    stops_its_motors_by_force_and_refuses_to_reboot,
)


def main() -> None:
    url, firmware, *names = sys.argv[1:]
    drone = connected(url, firmware)
    for case in CASES:
        if names and case.__name__ not in names:
            continue
        try:
            case(drone)
            outcome = "ok"
        except Exception as failed:  # noqa: BLE001 (whatever fails is told as this case's outcome)
            lines = [frame.lineno for frame in traceback.extract_tb(failed.__traceback__) if frame.filename == __file__]
            outcome = f"{type(failed).__name__} {failed} in lines {lines}"
        sys.stdout.write(f"CASE {case.__name__}={outcome}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
