"""What a check gathers from a vehicle's samples."""

import math
from typing import Any

import pytest
from rosbags.typesys.stores import ros2_humble as ros

from companion.check.vehicle_reading import VehicleReader
from companion.config.integrity import IntegrityConfig
from link.frames.rotations import quaternion_from_yaw
from link.messages import Fix, FixVelocity, Vector3, VehicleImu
from link.payloads import cdr
from link.zenoh.inbox import Inbox
from link.zenoh.pad_question import PadQuestion

START_NS = 1_795_000_000_000_000_000
PERIOD_NS = 100_000_000
CONFIG = IntegrityConfig()


class Nobody:
    """What is never asked here."""

    def ask(self, key: str, payload: bytes, timeout_s: float) -> Inbox:
        raise AssertionError(f"asked {key} with {payload!r} for {timeout_s} s")


NOT_ASKED = PadQuestion(Nobody(), "decklander/vehicle/pad")


def _after_a_drive(
    course_rad: float, off_rad: float, speed_m_s: float, imu_late_ns: int = 0, config: IntegrityConfig = CONFIG
) -> VehicleReader:
    reader = VehicleReader("decklander/vehicle/fix", config)
    for k in range(10):
        t_ns = START_NS + k * PERIOD_NS
        velocity = (speed_m_s * math.cos(course_rad), speed_m_s * math.sin(course_rad), 0.0)
        heading = VehicleImu(t_ns=t_ns - imu_late_ns, orientation_wxyz=quaternion_from_yaw(course_rad + off_rad))
        reader.imu(cdr.encode(heading))
        reader.velocity(cdr.encode(FixVelocity(t_ns=t_ns, velocity_enu_m_s=velocity)))
    return reader


@pytest.mark.parametrize("off_rad", [0.05, -0.4, 3.0])
@pytest.mark.parametrize("course_rad", [0.3, 3.1, -2.0])
def test_heading_is_compared_with_the_course_of_a_vehicle_that_drives(course_rad: float, off_rad: float) -> None:
    facts = _after_a_drive(course_rad, off_rad, 4.0).facts(NOT_ASKED)
    assert facts.has_velocity
    assert facts.tells_heading
    assert facts.heading_off_rad == pytest.approx(off_rad, abs=1e-6)
    assert facts.compared_speed_m_s == pytest.approx(4.0)


def test_nothing_is_compared_at_rest_or_long_after() -> None:
    assert _after_a_drive(0.3, 1.0, 0.5).facts(NOT_ASKED).heading_off_rad is None
    assert _after_a_drive(0.3, 1.0, 4.0, imu_late_ns=10**9).facts(NOT_ASKED).heading_off_rad is None


def test_course_begins_at_the_speed_that_the_configuration_says() -> None:
    later = CONFIG.model_copy(update={"course_speed_min_m_s": 5.0})
    assert _after_a_drive(0.3, 1.0, 4.0, config=later).facts(NOT_ASKED).heading_off_rad is None
    assert _after_a_drive(0.3, 1.0, 6.0, config=later).facts(NOT_ASKED).heading_off_rad is not None


@pytest.mark.parametrize(("force", "is_told"), [((0.1, 0.0, 9.8), True), ((0.0, 0.0, 0.0), False), (None, False)])
def test_acceleration_is_told_by_a_unit_that_measures_one(force: Vector3 | None, *, is_told: bool) -> None:
    facts = _told_forces(force).facts(NOT_ASKED)
    assert facts.tells_acceleration is is_told
    assert facts.acceleration_refused_why is None


def test_acceleration_in_other_units_is_none_and_says_why() -> None:
    facts = _told_forces((0.01, 0.0, 1.0)).facts(NOT_ASKED)
    assert not facts.tells_acceleration
    assert facts.acceleration_refused_why is not None


def _told_forces(force: Vector3 | None) -> VehicleReader:
    """Return what 1.2 s of a unit at 50 Hz have told."""
    reader = VehicleReader("decklander/vehicle/fix", CONFIG)
    for index in range(60):
        imu = VehicleImu(t_ns=START_NS + index * 20_000_000, specific_force_flu_m_s2=force)
        reader.imu(cdr.encode(imu))
    return reader


def _without_a_fix() -> bytes:
    fix = Fix(t_ns=START_NS, latitude_rad=0.8, longitude_rad=0.1, altitude_m=400.0)
    message: Any = cdr.typestore().deserialize_cdr(cdr.encode(fix), cdr.ROS_TYPES[Fix])
    message.status.status = ros.sensor_msgs__msg__NavSatStatus.STATUS_NO_FIX
    return bytes(cdr.typestore().serialize_cdr(message, cdr.ROS_TYPES[Fix]))


@pytest.mark.parametrize(
    ("payload", "why"),
    [
        (_without_a_fix(), "the receiver has no fix"),
        (cdr.encode(FixVelocity(t_ns=START_NS, velocity_enu_m_s=(1.0, 0.0, 0.0))), "not a sensor_msgs/msg/NavSatFix"),
    ],
)
def test_fixes_that_are_refused_are_told_with_the_cause(payload: bytes, why: str) -> None:
    reader = VehicleReader("decklander/vehicle/fix", CONFIG)
    for k in range(10):
        reader.fix(payload, START_NS + k * PERIOD_NS, START_NS + k * PERIOD_NS)
    facts = reader.facts(NOT_ASKED)
    assert facts.rate_hz == 0.0
    assert why in (facts.fix_refused_why or "")


def test_what_cannot_be_read_is_left_out() -> None:
    reader = VehicleReader("decklander/vehicle/fix", CONFIG)
    reader.imu(b"no imu")
    reader.velocity(b"no velocity")
    assert reader.facts(NOT_ASKED).heading_off_rad is None
