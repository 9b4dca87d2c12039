"""What is said of refused data."""

import math

import pytest

from companion.autopilots.state import AutopilotState
from companion.runtime.sample_intake import SAMPLES_MAX_PER_S, SampleIntake
from companion.runtime.step_clock import StepClock
from companion.runtime.vehicle_link import Refusals, VehicleLink
from link.frames.rotations import quaternion_from_yaw
from link.messages import PadSighting, VehicleImu
from link.payloads import cdr
from link.records import replace
from link.zenoh.keys import Keys
from tests.companion.world import START_NS, own_state

KEYS = Keys()
HOUR_NS = 3_600_000_000_000


def test_what_a_stranger_sent_reaches_no_terminal_as_it_came() -> None:
    refusals = Refusals()
    refusals.count("pad", "refused", "unknown field \x1b[2J", now_ns=1)
    (line,) = refusals.news(1)
    assert line.isprintable()
    assert refusals.recent(1) == line


SIGHTING = PadSighting(
    t_ns=START_NS,
    position_flu_m=(0.3, -0.2, -2.5),
    orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
    position_covariance_m2=(0.04, 0.01, 0.0, 0.01, 0.09, 0.0, 0.0, 0.0, 0.25),
)


@pytest.mark.parametrize("off_ns", [-HOUR_NS, 0, HOUR_NS])
@pytest.mark.parametrize("is_placed", [True, False])
def test_sighting_at_a_time_of_which_the_drones_place_is_not_known_is_refused(off_ns: int, *, is_placed: bool) -> None:
    history = (own_state(START_NS, (4.0, 5.0, 6.0)),) if is_placed else ()
    sighting = replace(SIGHTING, t_ns=START_NS + 1 + off_ns)
    vehicle = VehicleLink(KEYS, StepClock(50.0), None)
    vehicle.receive(KEYS.pad_pose, cdr.encode(sighting), AutopilotState(history=history))
    is_refused = is_placed and off_ns != 0
    assert vehicle.refusals.total == is_refused
    assert ("clock" in vehicle.refused_lately()) is is_refused
    assert vehicle.take(is_utc_known=True).has_unplaced_sightings is is_refused


@pytest.mark.parametrize("first", [True, False])
def test_sightings_are_not_unplaced_while_some_are_placed(*, first: bool) -> None:
    vehicle, state = (
        VehicleLink(KEYS, StepClock(50.0), None),
        AutopilotState(history=(own_state(START_NS, (4.0, 5.0, 6.0)),)),
    )
    for is_placed in (first, not first):
        off_ns = 0 if is_placed else HOUR_NS
        vehicle.receive(KEYS.pad_pose, cdr.encode(replace(SIGHTING, t_ns=START_NS + off_ns)), state)
    assert vehicle.refusals.total == 1
    assert not vehicle.take(is_utc_known=True).has_unplaced_sightings


def test_step_hears_once_that_something_of_the_inertial_unit_is_found_to_be_wrong() -> None:
    vehicle, told = VehicleLink(KEYS, StepClock(50.0), None), []
    for index in range(390):  # more in a second are refused
        imu = VehicleImu(
            t_ns=START_NS + 20_000_000 * index,
            orientation_wxyz=quaternion_from_yaw(0.15 * 0.02 * index),
            angular_velocity_flu_rad_s=(0.0, 0.0, math.degrees(0.15)),
        )
        vehicle.receive(KEYS.imu, cdr.encode(imu), AutopilotState())
        told.append(vehicle.take(is_utc_known=False).has_doubted_unit)
    assert sum(told) == 1
    assert vehicle.refused_lately().startswith("yaw rate")


def _clock() -> StepClock:
    """A clock that shows the time of the sightings."""
    clock = StepClock(50.0)
    clock.advance(START_NS, START_NS, None, 0)
    return clock


def _counted(vehicle: VehicleLink, key: str, payload: bytes) -> int:
    """Return how many measurements there are of a sample that comes now."""
    vehicle.receive(key, payload, AutopilotState(history=(own_state(START_NS, (4.0, 5.0, 6.0)),)))
    return len(vehicle.take(is_utc_known=False).measurements)


def test_sample_that_is_published_twice_counts_once_and_is_told() -> None:
    vehicle, payload = VehicleLink(KEYS, _clock(), None), cdr.encode(SIGHTING)
    assert [_counted(vehicle, KEYS.pad_pose, payload) for _ in range(3)] == [1, 0, 0]
    assert "published twice" in vehicle.refused_lately()


def test_copies_take_no_room_of_what_comes_first() -> None:
    vehicle = VehicleLink(KEYS, _clock(), None)
    for index in range(SAMPLES_MAX_PER_S):
        payload = cdr.encode(replace(SIGHTING, t_ns=START_NS + index))
        assert [_counted(vehicle, KEYS.pad_pose, payload) for _ in range(2)] == [1, 0]
    assert _counted(vehicle, KEYS.pad_pose, cdr.encode(replace(SIGHTING, t_ns=START_NS + SAMPLES_MAX_PER_S))) == 0


@pytest.mark.parametrize(("after_s", "refused"), [(0.9, "again"), (1.5, "again"), (2.5, None)])
def test_what_came_a_while_ago_is_forgotten(after_s: float, refused: str | None) -> None:
    intake, began_ns = SampleIntake(), 7_000_000_000
    assert intake.refusal(KEYS.fix, b"one", began_ns) is None
    for later_s in (1.2, 2.4):
        if later_s < after_s:
            intake.refusal(KEYS.fix, b"another", began_ns + round(later_s * 1e9))
    again = intake.refusal(KEYS.fix, b"one", began_ns + round(after_s * 1e9))
    assert (again and again[0]) == refused
    assert intake.refusal(KEYS.pad_pose, b"one", began_ns + round(after_s * 1e9)) is None
