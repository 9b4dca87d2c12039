"""The truth of the firmwares' simulations, and ArduPilot's ship, from their messages."""

import math

import pytest

from link.frames.geodesy import Datum, enu_from_geodetic, geodetic_from_enu
from link.frames.rotations import rotate
from link.mavlink.dialect import mavlink
from scenarios.firmware.ship import ASTERN_M, ShipReport, ship_at, ship_at_rest, ship_report
from scenarios.firmware.truth import body_truth, motors_armed, rotor_truth, true_pose

DATUM = Datum(latitude_rad=math.radians(47.4), longitude_rad=math.radians(8.5), altitude_m=488.0)
HALF = math.radians(90.0) / 2.0  # nose to the east
NS = 10**9


def _px4() -> mavlink.MAVLink_message:
    q = [math.cos(HALF), 0.0, 0.0, math.sin(HALF)]
    return mavlink.MAVLink_hil_state_quaternion_message(
        0, q, 0.1, 0.2, 0.3, 474_000_000, 85_000_000, 490_000, 300, -400, 50, 0, 0, 0, 0, 0
    )


def test_pose_is_about_the_datum_with_the_centre_above_the_feet() -> None:
    pose = true_pose(_px4())
    assert pose is not None
    truth = body_truth(pose, DATUM, 5 * NS, 0.12)
    assert truth.position_enu_m == pytest.approx((0.0, 0.0, 2.12), abs=1e-3)
    assert rotate(truth.orientation_wxyz, (1.0, 0.0, 0.0)) == pytest.approx((1.0, 0.0, 0.0), abs=1e-6)
    # 3 m/s to the north and 4 m/s to the west are to the left and backwards of a nose to the east.
    assert truth.velocity_flu_m_s == pytest.approx((-4.0, 3.0, -0.5), abs=1e-6)
    assert truth.angular_velocity_flu_rad_s == pytest.approx((0.1, -0.2, -0.3))


def test_motors_are_told_by_each_firmwares_own_message() -> None:
    armed = mavlink.MAV_MODE_FLAG_SAFETY_ARMED
    assert motors_armed(mavlink.MAVLink_heartbeat_message(2, 3, armed, 4, 4, 3)) is True
    assert motors_armed(mavlink.MAVLink_hil_actuator_controls_message(0, [0.0] * 16, 0, 0)) is False
    assert motors_armed(_px4()) is None
    assert set(rotor_truth(NS, armed=False).speed_rad_s) == {0.0}


def _northwards(speed_m_s: float) -> ShipReport:
    """Return the report of a ship at the datum that heads north."""
    return ShipReport(
        boot_ns=0,
        latitude_rad=DATUM.latitude_rad,
        longitude_rad=DATUM.longitude_rad,
        speed_m_s=speed_m_s,
        yaw_rad=math.radians(90.0),
    )


def test_ship_drives_on_its_circle_between_reports() -> None:
    radius_m, speed_m_s = 500.0, 8.0
    report = _northwards(speed_m_s)
    angle_rad = speed_m_s * 2.0 / radius_m
    ship = ship_at(report, 10 * NS, 12 * NS, DATUM, turn_radius_m=radius_m, ordered_m_s=speed_m_s)
    arc = (radius_m * (1.0 - math.cos(angle_rad)), radius_m * math.sin(angle_rad), 0.0)
    assert ship.position_enu_m == pytest.approx(arc, abs=1e-3)
    assert ship.yaw_rad == pytest.approx(math.radians(90.0) - angle_rad)
    assert math.hypot(*ship.velocity_enu_m_s) == pytest.approx(speed_m_s)
    assert math.hypot(*ship.acceleration_enu_m_s2) == pytest.approx(speed_m_s**2 / radius_m)


def test_ship_speeds_up_to_what_was_ordered_as_the_simulation_has_it() -> None:
    sails = _northwards(2.0)
    speeding, full = (
        ship_at(sails, 0, after_ns, DATUM, turn_radius_m=500.0, ordered_m_s=5.0) for after_ns in (NS // 2, 2 * NS)
    )
    assert math.hypot(*speeding.position_enu_m) == pytest.approx(2.0 * 0.5 + 0.5 * 3.0 * 0.5**2, abs=1e-3)
    assert math.hypot(*speeding.velocity_enu_m_s) == pytest.approx(3.5)
    assert speeding.acceleration_enu_m_s2[1] == pytest.approx(3.0, abs=1e-2)
    assert math.hypot(*full.position_enu_m) == pytest.approx(0.5 * (2.0 + 5.0) * 1.0 + 5.0 * 1.0, abs=1e-3)
    assert math.hypot(*full.velocity_enu_m_s) == pytest.approx(5.0)


@pytest.mark.parametrize("after_ns", [-5_000_000, 0, 5_000_000], ids=["before", "at", "after"])
def test_ship_at_its_speed_speeds_up_at_no_instant_about_its_report(after_ns: int) -> None:
    report = _northwards(5.0)
    ship = ship_at(report, 10 * NS, 10 * NS + after_ns, DATUM, turn_radius_m=500.0, ordered_m_s=5.0)
    assert math.hypot(*ship.velocity_enu_m_s) == pytest.approx(5.0)
    assert math.hypot(*ship.acceleration_enu_m_s2) == pytest.approx(5.0**2 / 500.0)


def test_ship_lies_where_and_as_its_first_report_has_it() -> None:
    latitude_rad, longitude_rad, _ = geodetic_from_enu(DATUM, (*ASTERN_M, 0.0))
    first = ShipReport(
        boot_ns=0, latitude_rad=latitude_rad, longitude_rad=longitude_rad, speed_m_s=0.0, yaw_rad=math.radians(90.0)
    )
    lies, sails = (
        ship_at_rest(7 * NS, ASTERN_M),
        ship_at(first, 7 * NS, 8 * NS, DATUM, turn_radius_m=500.0, ordered_m_s=5.0),
    )
    assert lies.position_enu_m == pytest.approx(sails.position_enu_m, abs=1e-3)
    assert (lies.t_ns, lies.velocity_enu_m_s, lies.orientation_wxyz) == (
        7 * NS,
        (0.0, 0.0, 0.0),
        sails.orientation_wxyz,
    )


def test_only_the_ships_own_position_is_its_report() -> None:
    message = mavlink.MAVLink_global_position_int_message(700, 474_000_000, 85_000_000, 0, 0, 300, 400, 0, 9000)
    assert ship_report(message) is None
    message._header.srcSystem = 17  # noqa: SLF001 (as a frame's sender is told)
    report = ship_report(message)
    assert report is not None
    assert (report.boot_ns, report.speed_m_s) == (700_000_000, 5.0)
    assert report.yaw_rad == pytest.approx(0.0)
    there = enu_from_geodetic(DATUM, report.latitude_rad, report.longitude_rad, DATUM.altitude_m)
    assert there == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)
