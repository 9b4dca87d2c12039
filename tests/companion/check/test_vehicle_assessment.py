"""The lines of the check on a vehicle: each thing amiss is told by its own line."""

import math
from typing import Any

import pytest

from companion.check.findings import Finding, Level
from companion.check.observation import VehicleFacts
from companion.check.vehicle_assessment import assess_vehicle
from companion.config.companion import CompanionConfig
from link.records import replace

VEHICLE = VehicleFacts(
    key="decklander/vehicle/fix",
    rate_hz=10.0,
    age_s=0.1,
    std_m=0.05,
    has_velocity=True,
    tells_acceleration=True,
    describes_pad=True,
)


def by_name(seen: VehicleFacts) -> dict[str, Finding]:
    return {one.name: one for one in assess_vehicle(seen, CompanionConfig())}


@pytest.mark.parametrize(
    ("changed", "line", "level"),
    [
        ({"rate_hz": 0.0}, "vehicle", Level.WARN),
        ({"rate_hz": 0.0, "fix_refused_why": "the receiver has no fix"}, "vehicle", Level.FAIL),
        ({"rate_hz": 1.0}, "vehicle fixes", Level.FAIL),
        ({"rate_hz": 2.0}, "vehicle fixes", Level.WARN),
        ({"rate_hz": 5.0, "has_velocity": False}, "vehicle fixes", Level.WARN),
        ({"age_s": 2.0}, "vehicle age", Level.FAIL),
        ({"age_s": -3600.0}, "vehicle age", Level.FAIL),
        ({"age_s": None}, "vehicle age", Level.WARN),
        ({"heading_off_rad": math.pi}, "vehicle heading", Level.FAIL),
        ({"heading_off_rad": -0.3}, "vehicle heading", Level.FAIL),
        ({"antenna_behind_pad_m": 2.6}, "vehicle heading", Level.WARN),
        ({"std_m": 1.0}, "vehicle accuracy", Level.WARN),
        ({"std_m": 5.0}, "vehicle accuracy", Level.FAIL),
        ({"std_m": None}, "vehicle accuracy", Level.WARN),
        ({"tells_acceleration": False}, "vehicle brakes", Level.WARN),
        ({"tells_acceleration": False, "acceleration_refused_why": "units"}, "vehicle brakes", Level.WARN),
        ({"describes_pad": False}, "vehicle pad", Level.FAIL),
        ({"pad_width_m": 0.6}, "vehicle pad", Level.FAIL),
        ({"describes_pad": False, "pad_refused_why": "antenna_to_pad_m.0: 60"}, "vehicle pad", Level.FAIL),
    ],
)
def test_vehicle_amiss_is_told(changed: dict[str, Any], line: str, level: Level) -> None:
    lines = by_name(replace(VEHICLE, **changed))
    assert lines[line].level is level
    assert lines[line].advice


def test_vessel_is_not_asked_how_it_brakes() -> None:
    vessel = replace(VEHICLE, is_afloat=True, tells_acceleration=False)
    assert "vehicle brakes" not in by_name(vessel)


@pytest.mark.parametrize(
    "changed",
    [
        {"antenna_behind_pad_m": 2.4},
        {"antenna_behind_pad_m": -6.0},
        {"antenna_behind_pad_m": 6.0, "tells_heading": True},
    ],
)
def test_course_shows_the_heading_unless_the_antenna_is_far_behind_the_pad(changed: dict[str, Any]) -> None:
    assert "vehicle heading" not in by_name(replace(VEHICLE, **changed))


@pytest.mark.parametrize(("rate_hz", "has_velocity"), [(5.0, True), (10.0, False)])
def test_rate_that_shows_the_speed_passes(rate_hz: float, *, has_velocity: bool) -> None:
    seen = replace(VEHICLE, rate_hz=rate_hz, has_velocity=has_velocity)
    lines = by_name(seen)
    assert lines["vehicle fixes"].level is Level.PASS


def test_heading_that_follows_the_course_passes() -> None:
    lines = by_name(replace(VEHICLE, heading_off_rad=0.1))
    assert lines["vehicle heading"].level is Level.PASS


@pytest.mark.parametrize(
    ("off_rad", "speed_m_s", "is_afloat", "level"),
    [
        (0.4, 2.2, True, Level.PASS),
        (0.4, 2.2, False, Level.FAIL),
        (0.4, 10.0, True, Level.FAIL),
        (-math.pi / 2.0, 2.2, True, Level.FAIL),
        (math.pi, 1.4, True, Level.PASS),
    ],
)
def test_heading_of_a_vessel_may_be_off_by_its_drift(
    off_rad: float, speed_m_s: float, *, is_afloat: bool, level: Level
) -> None:
    seen = replace(VEHICLE, heading_off_rad=off_rad, compared_speed_m_s=speed_m_s, is_afloat=is_afloat)
    lines = by_name(seen)
    assert lines["vehicle heading"].level is level
