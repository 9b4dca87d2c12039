import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import fresnel

from link.errors import UserError
from link.program.toml_config import validate
from scenarios.tracks.clothoids import clothoid_road
from scenarios.tracks.drive import drive_course, driven, shifted
from scenarios.tracks.drive_config import DriveTrack, SuspensionConfig
from scenarios.tracks.heights import grade_line
from scenarios.tracks.profiles import profile_of
from scenarios.tracks.suspension import STEP_S, Array, Driven, Surface, dive_after, sway_of

STIFF = SuspensionConfig(dive_rad_s2_m=0.004, lean_rad_s2_m=0.01)
FLAT = Surface(waves=(), humps=())
BRAKES = ((5.0, 2.0), (10.0, 0.0), (2.5, -4.0))


def still(count: int, *, along_m_s2: float = 0.0, left_m_s2: float = 0.0, speed_m_s: float = 0.0) -> Driven:
    """A drive at one speed, with accelerations that begin at once."""
    times_s: Array = (np.arange(count, dtype=np.float64) + 0.5) * STEP_S
    level: Array = np.ones(count)
    return Driven(
        s_m=speed_m_s * times_s,
        speed_m_s=speed_m_s * level,
        along_m_s2=along_m_s2 * level,
        left_m_s2=left_m_s2 * level,
    )


@pytest.mark.parametrize(("length_m", "end_per_m"), [(40.0, 0.05), (130.0, -0.09), (3.0, 0.15)])
def test_clothoid_is_the_fresnel_integral(length_m: float, end_per_m: float) -> None:
    road = clothoid_road([(length_m, 0.0, end_per_m)], start_m=(0.0, 0.0), heading_rad=0.0)
    scale_m = math.sqrt(math.pi * length_m / abs(end_per_m))
    for share in (0.13, 0.5, 0.77, 1.0):
        sine, cosine = fresnel(share * length_m / scale_m)
        at = road.at(share * length_m)
        assert at.x_m == pytest.approx(scale_m * cosine, abs=1e-9)
        assert at.y_m == pytest.approx(math.copysign(scale_m * sine, end_per_m), abs=1e-9)
        assert at.curvature_per_m == pytest.approx(share * end_per_m)
        assert at.heading_rad == pytest.approx(0.5 * share**2 * length_m * end_per_m)


def test_shift_ends_beside_the_road_in_its_direction() -> None:
    road = clothoid_road(shifted([(200.0, 0.0, 0.0)], [(20.0, 60.0, 3.5)]), start_m=(0.0, 0.0), heading_rad=0.0)
    end = road.at(120.0)
    assert end.heading_rad == pytest.approx(0.0, abs=1e-12)
    assert end.y_m == pytest.approx(3.5, rel=0.01)  # to the first order in the angle of 0.12 rad
    assert road.length_m == pytest.approx(200.0)


def test_shift_adds_to_the_curvature_of_the_road() -> None:
    bend = [(30.0, 0.0, 0.02), (50.0, 0.02, 0.02), (30.0, 0.02, 0.0)]
    plain = clothoid_road(bend, start_m=(0.0, 0.0), heading_rad=0.3)
    both = clothoid_road(shifted(bend, [(20.0, 40.0, -2.0)]), start_m=(0.0, 0.0), heading_rad=0.3)
    sharpest_per_m = -8.0 * 2.0 / 40.0**2
    added = [
        both.at(s_m).curvature_per_m - plain.at(s_m).curvature_per_m for s_m in (10.0, 25.0, 30.0, 40.0, 50.0, 70.0)
    ]
    shares = [0.0, 0.5, 1.0, 0.0, -1.0, 0.0]
    np.testing.assert_allclose(added, [share * sharpest_per_m for share in shares], atol=1e-12)


def test_grade_line_is_the_integral_of_its_grades() -> None:
    line = grade_line([(0.0, 0.0), (40.0, 0.0), (60.0, 0.05), (90.0, 0.05), (130.0, -0.03)])
    for s_m in np.linspace(-5.0, 160.0, 111).tolist():
        (before, _, _), (_, grade, change), (after, _, _) = (line.at(s_m + step) for step in (-1e-4, 0.0, 1e-4))
        assert (after - before) / 2e-4 == pytest.approx(grade, abs=1e-6)
        assert (line.at(s_m + 1e-4)[1] - grade) / 1e-4 == pytest.approx(change, abs=1e-6)
    assert line.at(75.0)[0] == pytest.approx(0.5 * 0.05 * 20.0 + 0.05 * 15.0)


@pytest.mark.parametrize("grades", [[], [(0.0, 0.0), (0.0, 0.1)], [(5.0, 0.0), (4.0, 0.1)]])
def test_grades_out_of_order_raise(grades: list[tuple[float, float]]) -> None:
    with pytest.raises(ValueError, match="ascending"):
        grade_line(grades)


def test_body_dives_when_braking_and_leans_out_of_the_turn_in_the_long_run() -> None:
    sway = sway_of(still(1500, along_m_s2=-6.0, left_m_s2=3.0), FLAT, STIFF)
    heave, pitch, roll = sway.at(14.5)
    assert heave == pytest.approx((0.0, 0.0, 0.0))
    assert pitch == pytest.approx((0.024, 0.0, 0.0), abs=1e-9)  # nose down, rotation about the left
    assert roll == pytest.approx((0.03, 0.0, 0.0), abs=1e-9)  # left side up in a turn to the left


def test_body_on_its_springs_is_what_an_integrator_makes_of_the_equation() -> None:
    wave, speed_m_s, c = (0.03, 7.0, 0.0, 0.4), 9.0, STIFF
    sway = sway_of(still(500, speed_m_s=speed_m_s), Surface(waves=(wave,), humps=()), c)
    k, w = 2.0 * math.pi / wave[1], 2.0 * math.pi * c.heave_hz
    amplitude_m = wave[0] * math.cos(0.5 * k * c.wheelbase_m)
    begin_m = amplitude_m * math.sin(k * speed_m_s * 0.5 * STEP_S + wave[3])

    def rate(t_s: float, x: np.ndarray) -> list[float]:
        angle = k * speed_m_s * t_s + wave[3]
        base, base_rate = amplitude_m * math.sin(angle) - begin_m, amplitude_m * k * speed_m_s * math.cos(angle)
        return [x[1], w**2 * (base - x[0]) + 2.0 * c.damping * w * (base_rate - x[1])]

    times_s = np.linspace(0.3, 4.9, 47)
    wanted = solve_ivp(rate, (0.0, 5.0), [0.0, 0.0], t_eval=times_s, rtol=1e-9, atol=1e-12).y
    ours = np.array([sway.at(t_s)[0][:2] for t_s in times_s.tolist()]).T
    greatest = np.abs(wanted).max(axis=1, keepdims=True)
    np.testing.assert_allclose(ours / greatest, wanted / greatest, atol=2e-3)


def test_rates_of_the_swaying_are_its_derivatives_between_the_grid_too() -> None:
    surface = Surface(waves=((0.02, 4.0, 0.7, 1.0),), humps=((12.0, 3.7, 0.08),))
    sway = sway_of(still(600, speed_m_s=6.0, along_m_s2=-2.0, left_m_s2=1.0), surface, STIFF)
    for t_s in np.linspace(0.0137, 5.9, 91).tolist():
        for before, now, after in zip(sway.at(t_s - 1e-6), sway.at(t_s), sway.at(t_s + 1e-6), strict=True):
            assert (after[0] - before[0]) / 2e-6 == pytest.approx(now[1], abs=1e-5)


def test_hump_lifts_the_body_by_its_height_when_it_is_crossed_slowly() -> None:
    surface = Surface(waves=(), humps=((10.0, 12.0, 0.1),))
    sway = sway_of(still(6000, speed_m_s=0.25), surface, STIFF.model_copy(update={"wheelbase_m": 0.5}))
    assert max(sway.heave[0]) == pytest.approx(0.1, rel=0.02)


def test_body_is_at_rest_before_departure_and_behind_the_end() -> None:
    sway = sway_of(still(300, left_m_s2=2.0), FLAT, STIFF)
    assert sway.at(-1.0) == ((0.0, 0.0, 0.0),) * 3
    assert sway.at(100.0)[2][1:] == (0.0, 0.0)


def test_body_dives_for_a_brake_that_nobody_planned_as_for_one_that_was() -> None:
    course = drive_course(DriveTrack(kind="drive", begins_m=(0.0, 0.0), stretches=((500.0, 0.0, 0.0),), legs=BRAKES))
    level = DriveTrack(kind="drive", begins_m=(0.0, 0.0), stretches=((500.0, 0.0, 0.0),), legs=BRAKES[:2])
    pulled = drive_course(level)
    assert course.sway is not None
    assert pulled.sway is not None
    for since_s in (0.0, 0.1, 0.3, 1.0, 2.4, 2.6, 4.0):
        planned, before = course.sway.at(15.0 + since_s)[1], pulled.sway.at(15.0 + since_s)[1]
        dives = dive_after(since_s, 4.0, 2.5, SuspensionConfig())
        assert planned[:2] == pytest.approx((before[0] + dives[0], before[1] + dives[1]), abs=1e-4)


def test_drive_keeps_to_its_legs_and_its_bend() -> None:
    stretches = ((100.0, 0.0, 0.0), (20.0, 0.0, 0.05), (60.0, 0.05, 0.05))
    legs = ((5.0, 2.0), (20.0, 0.0), (2.0, -5.0))
    course = drive_course(DriveTrack(kind="drive", begins_m=(0.0, 0.0), stretches=stretches, legs=legs))
    motion = driven(course.road, profile_of(legs))
    i = round(17.0 / STEP_S)
    assert motion.s_m[i] == pytest.approx(25.0 + 10.0 * (12.0 + 0.5 * STEP_S))
    assert motion.left_m_s2[i] == pytest.approx(0.05 * 10.0**2)
    assert motion.along_m_s2[round(26.0 / STEP_S)] == -5.0
    assert course.profile.at(60.0).speed_m_s == 0.0


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"stretches": [[10.0, 0.0, 0.1], [10.0, 0.0, 0.0]]}, "curvature jumps between stretches[0] and [1]"),
        ({"stretches": []}, "stretches"),
        ({"grades": [[5.0, 0.0], [5.0, 0.1]]}, "grades[1] must be behind grades[0]"),
        ({"legs": [[5.0, 1.0], [6.0, -1.0]]}, "legs[1] ends in reverse"),
        ({"legs": [[-5.0, 1.0]]}, "legs[0][0]"),
        ({"legs": [[10_000.0, 1.0]]}, "legs[0] ends at 1e+04 m/s"),
        ({"grades": [[5.0, 2.0]]}, "grades[0][1]"),
        ({"shifts": [[5.0, 1e-6, 3.0]]}, "shifts[0] is too short for 3 m to the side"),
        ({"stretches": [[10.0, 1e9, 0.0]]}, "stretches[0][1]"),
    ],
)
def test_drive_that_no_vehicle_can_drive_is_refused(change: dict[str, object], told: str) -> None:
    table = {"kind": "drive", "begins_m": [0.0, 0.0], "stretches": [[10.0, 0.0, 0.0]], "legs": [[5.0, 1.0]]} | change
    with pytest.raises(UserError) as error:
        validate(DriveTrack, table, source="own.toml")
    assert told in str(error.value)
