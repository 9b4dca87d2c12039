"""What the range finder sees of the deck: a height of the pad, as far as it is of the pad."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from companion.config.estimation import EstimatorConfig, EstimatorKind
from companion.config.touchdown import TouchdownConfig
from companion.core.data import Array, Measurement, OwnState, Quantity, RangeReading
from companion.vehicle.estimator import Estimator
from companion.vehicle.factory import make_estimator
from companion.vehicle.imm_numbers import Deck
from companion.vehicle.range_watch import RangeWatch, watch_ranges
from companion.vehicle.surface import higher_by_road_m, pad_height_seen, surface_measurements
from link.frames.rotations import quaternion_from_roll_pitch_yaw
from link.messages import PadGeometry
from link.records import replace
from tests.companion.vehicle.drives import ANTENNA_TO_PAD_M, DEGRADED, NOMINAL, Drive, Sensors, climb, drive, straight
from tests.companion.vehicle.rides import arrivals, now_ns

HALF_WIDTH_M = 0.75
ROOF_M = 1.5
Place = tuple[float, float, float]
Slope = tuple[float, float]
CONFIG = TouchdownConfig()
SIGHTED = replace(NOMINAL, pad_rate_hz=30.0)
SIGHTED_S = 3.0
RANGED_HZ = 20.0
NOW_NS, LATER_NS = now_ns(0.05), now_ns(1.0)


def _estimator(kind: EstimatorKind = EstimatorKind.IMM, half_width_m: float = HALF_WIDTH_M) -> Estimator:
    return make_estimator(EstimatorConfig(), Deck(antenna_to_pad_m=ANTENNA_TO_PAD_M, half_width_m=half_width_m), kind)


def _reading(roll_rad: float = 0.0, attitude_age_s: float = 0.0) -> RangeReading:
    own = OwnState(
        t_ns=now_ns(0.0),
        position_enu_m=(3.0, 4.0, 5.0),
        velocity_enu_m_s=(0.0, 0.0, 0.0),
        orientation_wxyz=quaternion_from_roll_pitch_yaw(roll_rad, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
        attitude_age_s=attitude_age_s,
    )
    return RangeReading(t_ns=own.t_ns, distance_m=2.0, own=own)


def _surface(value: Array, t_s: float = 0.0, apart_std_m: float = math.inf, rises_m: float = 0.0) -> Measurement:
    covariance = np.diag([apart_std_m**2, apart_std_m**2, 0.03**2, 2.0 * 0.03**2])
    told = np.append(value, rises_m)
    return Measurement(t_ns=now_ns(t_s), quantity=Quantity.SURFACE, value=told, covariance=covariance)


def _known(truth: Drive, until_s: float, *, sighted_s: float = SIGHTED_S) -> list[Measurement]:
    """What the vehicle told until then, and the sightings at first: below half a metre a detector is blind."""
    return [
        one
        for one in arrivals(truth, SIGHTED, 5)
        if one.t_ns < now_ns(sighted_s if one.quantity is Quantity.PAD else until_s)
    ]


def _ranged(truth: Drive, until_s: float, error_m: Array, apart_std_m: float = math.inf) -> list[Measurement]:
    """Surfaces at the pad's centre from the sightings' end on, off by up to `error_m` (3,) at the end."""
    times = np.arange(SIGHTED_S, until_s, 1.0 / RANGED_HZ).tolist()
    share = [(t - SIGHTED_S) / (until_s - SIGHTED_S) for t in times]
    return [_surface(truth.pad_at(t) + part * error_m, t, apart_std_m) for t, part in zip(times, share, strict=True)]


def _pad(chosen: Estimator, measurements: list[Measurement], t_s: float) -> tuple[Array, Array]:
    """The pad's place and velocity, as the estimator has them."""
    forecast = chosen.forecast(chosen.fuse(None, measurements), now_ns(t_s), np.array([0.0, 0.1]))
    assert forecast is not None
    return forecast.position_enu_m[0] + _arm(forecast.yaw_rad), forecast.velocity_enu_m_s[0]


def _arm(yaw_rad: Array | None) -> Array:
    assert yaw_rad is not None
    x, y, z = ANTENNA_TO_PAD_M
    c, s = math.cos(yaw_rad[0]), math.sin(yaw_rad[0])
    return np.array([c * x - s * y, s * x + c * y, z])


@pytest.mark.parametrize(
    ("roll_rad", "left_m", "down_m"), [(0.0, 0.0, 2.0), (0.3, 0.591, 1.911), (-0.3, -0.591, 1.911)]
)
def test_place_is_at_the_end_of_the_beam_which_leans_with_the_drone(
    roll_rad: float, left_m: float, down_m: float
) -> None:
    (seen,) = surface_measurements(_reading(roll_rad), 0.0, NOW_NS, CONFIG, 0.0)
    assert seen.quantity is Quantity.SURFACE
    assert seen.value == pytest.approx([3.0, 4.0 + left_m, 5.0 - down_m, 0.0], abs=1e-3)


def test_range_finder_higher_than_the_place_that_is_reported_sees_from_there() -> None:
    higher = CONFIG.model_copy(
        update={"range_finder": CONFIG.range_finder.model_copy(update={"height_m": CONFIG.gear_height_m + 0.1})}
    )
    (seen,), (level,) = (
        surface_measurements(_reading(), 0.0, NOW_NS, higher, 0.0),
        surface_measurements(_reading(), 0.0, NOW_NS, CONFIG, 0.0),
    )
    assert seen.value[2] == pytest.approx(level.value[2] + 0.1)


@pytest.mark.parametrize(
    "reading",
    [
        replace(_reading(), own=None),
        _reading(attitude_age_s=0.2),
        _reading(roll_rad=0.7),
        replace(_reading(), t_ns=NOW_NS + 1),
        replace(_reading(), t_ns=NOW_NS - 600_000_000),
    ],
)
def test_nothing_is_seen_from_an_unknown_place_or_attitude_or_beside_or_at_another_time(reading: RangeReading) -> None:
    assert surface_measurements(reading, 0.0, NOW_NS, CONFIG, 0.0) == ()


def _seen(
    away_m: Place,
    std_m: float = 0.02,
    above_road_m: float = ROOF_M,
    slope_enu: Slope = (0.0, 0.0),
    rises_m: float = 0.0,
) -> Measurement | None:
    pad = np.array([10.0, 20.0, 1.5])
    return pad_height_seen(
        _surface(pad + np.array(away_m), rises_m=rises_m),
        pad,
        pad_std_m=std_m,
        slope_enu=slope_enu,
        half_width_m=HALF_WIDTH_M,
        above_road_m=above_road_m,
    )


@pytest.mark.parametrize(
    ("away_m", "std_m", "is_pad"),
    [
        ((0.0, 0.0, 0.0), 0.02, True),
        ((0.7, 0.0, 0.0), 0.02, True),
        ((0.0, -0.8, 0.0), 0.02, False),
        ((0.5, 0.0, 0.0), 0.2, False),
    ],
)
def test_only_what_is_surely_within_the_pad_is_the_pads(away_m: Place, std_m: float, *, is_pad: bool) -> None:
    assert (_seen(away_m, std_m) is not None) is is_pad


@pytest.mark.parametrize(
    ("up_m", "above_road_m", "rises_m", "is_pad"),
    [
        (-0.7, ROOF_M, 0.0, True),
        (-0.8, ROOF_M, 0.0, False),  # nearer to the road
        (-ROOF_M, ROOF_M, 0.1, False),
        (-1.3, ROOF_M, 1.4, True),  # the road was seen, lower still
        (-2.1, ROOF_M, 1.4, False),
        (-0.2, 0.3, 0.0, False),
        (-0.3, 0.3, 0.4, False),  # of a pad that low an own height that wanders looks like a step
        (-1.4, 3.0, 0.0, True),
        (-2.1, 5.0, 0.0, False),
        (0.9, ROOF_M, 0.0, True),
        (1.1, ROOF_M, 3.0, False),  # somebody stands on it
        (2.3, ROOF_M, 1.3, True),  # the road is as much higher than it is said to be
        (2.3, ROOF_M, 0.5, False),
        (4.1, ROOF_M, 1.5, False),
        (1.2, 0.3, 0.4, False),
        (-0.9, 0.0, 0.0, True),  # a pad on the ground has no road below
        (1.1, 0.0, 0.0, False),
    ],
)
def test_road_and_what_stands_on_the_pad_are_not_the_pads(
    up_m: float, above_road_m: float, rises_m: float, *, is_pad: bool
) -> None:
    assert (_seen((0.0, 0.0, up_m), above_road_m=above_road_m, rises_m=rises_m) is not None) is is_pad


ROOF = PadGeometry(antenna_to_pad_m=(-0.4, 0.0, -0.1), size_m=(1.5, 1.5), height_m=ROOF_M)


def _watched(surfaces_m: Sequence[float], antenna_m: float) -> RangeWatch:
    """What is kept of surfaces that were seen one after the other, with the vehicle's antenna as high as given."""
    watch, up_m = RangeWatch(), CONFIG.range_finder.height_m - CONFIG.gear_height_m
    for i, surface_m in enumerate(surfaces_m):
        seen = _reading()
        own = replace(seen.own, t_ns=now_ns(0.05 * i)) if seen.own is not None else None
        told = replace(seen, t_ns=now_ns(0.05 * i), distance_m=5.0 + up_m - surface_m, own=own)
        watch, _ = watch_ranges(watch, told, antenna_m)
    return watch


@pytest.mark.parametrize("higher_m", [-1.0, 0.0, 0.7, 2.3])
def test_pad_is_as_much_higher_as_the_road_that_is_seen(higher_m: float) -> None:
    antenna_m, road_m = ROOF_M + 0.1, higher_m
    seen = _watched([road_m] * 8, antenna_m)
    assert higher_by_road_m(seen, LATER_NS, ROOF, CONFIG) == pytest.approx(max(higher_m, 0.0))
    over_roof = _watched([road_m] * 8 + [road_m + ROOF_M] * 8, antenna_m)
    assert higher_by_road_m(over_roof, LATER_NS, ROOF, CONFIG) == pytest.approx(max(higher_m, 0.0))


def test_road_tells_nothing_before_it_was_seen_and_long_after() -> None:
    seen = _watched([2.0] * 8, ROOF_M + 0.1)
    assert higher_by_road_m(RangeWatch(), LATER_NS, ROOF, CONFIG) == 0.0
    assert higher_by_road_m(seen, LATER_NS, ROOF, CONFIG) > 1.9
    assert higher_by_road_m(seen, now_ns(11.0), ROOF, CONFIG) == 0.0


@pytest.mark.parametrize("pad", [None, replace(ROOF, is_afloat=True)], ids=["not_described", "afloat"])
def test_road_tells_nothing_of_a_pad_that_is_not_described_or_afloat(pad: PadGeometry | None) -> None:
    assert higher_by_road_m(_watched([2.0] * 8, ROOF_M + 0.1), LATER_NS, pad, CONFIG) == 0.0


def test_height_is_that_of_the_centre_of_a_deck_that_slopes() -> None:
    seen = _seen((0.5, -0.2, 0.04), slope_enu=(0.12, 0.1))
    assert seen is not None
    assert seen.value == pytest.approx([1.5])


@pytest.mark.parametrize(("heading_std_rad", "counts"), [(0.02, True), (0.0, False)])
def test_pad_beside_its_antenna_is_ranged_only_with_a_heading(heading_std_rad: float, *, counts: bool) -> None:
    truth, until_s = drive(8.0, lambda _: 0.0, lambda _: 0.0), 7.0
    sensors = replace(NOMINAL, heading_std_rad=heading_std_rad, yaw_rate_std_rad_s=0.0, velocity_std_m_s=0.0)
    known = [one for one in arrivals(truth, sensors, 5) if one.t_ns < now_ns(until_s)]
    chosen, error = _estimator(), np.array([0.0, 0.0, -0.6])
    heights_m = []
    for told in (known, known + _ranged(truth, until_s, error, 0.0)):
        estimate = chosen.estimate(chosen.fuse(None, told), now_ns(until_s))
        assert estimate is not None
        heights_m.append(estimate.position_enu_m[2])
    assert heights_m[1] - heights_m[0] == pytest.approx(-0.6 if counts else 0.0, abs=0.1)


@pytest.mark.parametrize("drift_m", [-0.6, 0.6])
def test_pad_follows_the_drones_own_height_as_it_wanders(drift_m: float) -> None:
    truth, until_s, error = straight(5.0, 40.0), 35.0, np.array([0.0, 0.0, drift_m])
    known = _known(truth, until_s)
    there = truth.pad_at(until_s) + error
    without, _ = _pad(_estimator(), known, until_s)
    ranged, _ = _pad(_estimator(), known + _ranged(truth, until_s, error), until_s)
    assert abs(without[2] - there[2]) > 0.5
    assert abs(ranged[2] - there[2]) < CONFIG.range_finder.contact_height_max_m
    assert ranged[:2] == pytest.approx(there[:2], abs=0.15)


@pytest.mark.parametrize(
    ("sensors", "apart_std_m", "follows"),
    [
        (NOMINAL, 0.0, True),
        (NOMINAL, 1.0, False),
        (NOMINAL, math.inf, False),
        (replace(DEGRADED, heading_std_rad=0.02), 0.0, False),
    ],
)
def test_pad_that_fixes_place_well_in_the_drones_frame_needs_no_sighting(
    sensors: Sensors, apart_std_m: float, *, follows: bool
) -> None:
    truth, until_s, error = straight(5.0), 8.0, np.array([0.0, 0.0, -0.6])
    known = [one for one in arrivals(truth, sensors, 5) if one.t_ns < now_ns(until_s)]
    without, _ = _pad(_estimator(), known, until_s)
    ranged, _ = _pad(_estimator(), known + _ranged(truth, until_s, error, apart_std_m), until_s)
    assert ranged[2] - without[2] == pytest.approx(-0.6 if follows else 0.0, abs=0.1)


@pytest.mark.parametrize("rate_m_s", [-0.1, 0.1])
def test_height_that_wanders_is_followed_within_a_decimetre(rate_m_s: float) -> None:
    """The filter's noise knows such a rate, but for how long it lasts (PX4's own height: docs/real_autopilots.md)."""
    truth, until_s = straight(5.0), 8.0
    error = np.array([0.0, 0.0, rate_m_s * (until_s - SIGHTED_S)])
    known = _known(truth, until_s)
    _, unranged = _pad(_estimator(), known, until_s)
    pad, velocity = _pad(_estimator(), known + _ranged(truth, until_s, error), until_s)
    assert pad[2] == pytest.approx(truth.pad_at(until_s)[2] + error[2], abs=0.1)
    assert velocity[2] == pytest.approx(unranged[2], abs=0.05)


def test_deck_that_comes_up_is_seen_to_where_the_vehicle_tells_it_late() -> None:
    begins_s, late_s = 6.0, 0.3
    truth = climb(0.12, 12.0, from_s=begins_s)
    behind_m_s: tuple[list[float], list[float]] = ([], [])
    for t_s in (begins_s + after_s for after_s in (0.4, 0.5, 0.6)):  # before, it may as well be the body's heave
        told = [one for one in _known(truth, t_s - late_s) if one.quantity is not Quantity.VELOCITY]
        for ranges, behind in zip(([], _ranged(truth, t_s, np.zeros(3))), behind_m_s, strict=True):
            behind.append(float(truth.at(t_s)[1][2] - _pad(_estimator(), told + ranges, t_s)[1][2]))
    assert (np.array(behind_m_s[1]) < 0.8 * np.array(behind_m_s[0])).all()


def test_surface_counts_for_nothing_where_the_pad_is_not_placed_or_not_described() -> None:
    truth, until_s = straight(5.0), 5.0
    ranged = _ranged(truth, until_s, np.array([0.0, 0.0, 0.3]))
    for known, half_width_m in ((_known(truth, until_s, sighted_s=0.0), HALF_WIDTH_M), (_known(truth, until_s), 0.0)):
        chosen = _estimator(half_width_m=half_width_m)
        assert _pad(chosen, known + ranged, until_s)[0] == pytest.approx(_pad(chosen, known, until_s)[0], abs=1e-3)


def test_range_finder_that_is_stuck_does_not_move_the_pad() -> None:
    truth, until_s = straight(5.0), 8.0
    known = _known(truth, until_s, sighted_s=until_s)
    stuck = [_surface(truth.pad_at(t) + np.array([0.0, 0.0, 0.6]), t) for t in np.arange(5.0, until_s, 0.05).tolist()]
    chosen = _estimator()
    assert _pad(chosen, known + stuck, until_s)[0][2] == pytest.approx(truth.pad_at(until_s)[2], abs=0.05)
    assert chosen.health(chosen.fuse(None, known + stuck)).recoveries == 0


@pytest.mark.parametrize("error_m", [0.0, 0.6])
def test_ranges_count_neither_for_nor_against_what_the_vehicle_tells(error_m: float) -> None:
    truth, until_s, chosen = straight(5.0), 8.0, _estimator()
    known = _known(truth, until_s, sighted_s=until_s)
    error = np.array([0.0, 0.0, error_m])
    ranged = [_surface(truth.pad_at(t) + error, t) for t in np.arange(5.0, until_s, 0.05).tolist()]
    without, health = (chosen.health(chosen.fuse(None, told)) for told in (known, known + ranged))
    assert all(health.counts(one) == without.counts(one) for one in Quantity if one is not Quantity.SURFACE)
    assert health.nis_dof > without.nis_dof if error_m == 0.0 else health.nis_dof == without.nis_dof


@pytest.mark.parametrize("kind", [EstimatorKind.UKF, EstimatorKind.LKF, EstimatorKind.LKF_REPORT])
def test_filters_of_the_antenna_alone_leave_it_out(kind: EstimatorKind) -> None:
    truth, until_s, chosen = straight(5.0), 5.0, _estimator(kind)
    known = _known(truth, until_s, sighted_s=0.0)
    memory = chosen.fuse(None, known)
    before = chosen.estimate(memory, now_ns(until_s))
    after = chosen.estimate(chosen.fuse(memory, _ranged(truth, until_s, np.zeros(3))), now_ns(until_s))
    assert before is not None
    assert after is not None
    assert after.position_enu_m == pytest.approx(before.position_enu_m, abs=1e-3)
