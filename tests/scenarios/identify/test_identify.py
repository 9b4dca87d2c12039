"""Manoeuvres, figures and the fitted law, against closed forms; flights against what cannot be flown."""

import numpy as np
import pytest
from typer.testing import CliRunner

from companion.autopilots.px4 import Px4Driver
from companion.core.data import Array
from link.errors import UserError
from scenarios.app import app
from scenarios.identify.figures import figures
from scenarios.identify.fit import fit_law
from scenarios.identify.flying import fly_stand_in
from scenarios.identify.manoeuvres import CIRCLE_RADIUS_M, DURATION_S, MANOEUVRES, Name, span_s, wish_at
from scenarios.identify.pilot import Flight, Pilot

LATE_S = 0.07


def late_flight(t_s: Array, late_s: float) -> Flight:
    """A drone that is where it was asked to be, but for a delay."""
    asked = np.array([wish_at(t - late_s)[:2] for t in t_s])
    cascade = Px4Driver().cascade({})
    return Flight(
        autopilot="px4", t_s=t_s, position_m=asked[:, 0], velocity_m_s=asked[:, 1], cascade=cascade, shaping=None
    )


@pytest.fixture(scope="module")
def late() -> dict[str, float]:
    """The figures of a drone that is late."""
    return figures(late_flight(np.arange(0.013, DURATION_S, 0.02), LATE_S))


def test_ways_move_as_their_velocities_and_accelerations_say() -> None:
    for one in MANOEUVRES:
        for t_s in (0.37 * one.duration_s, 0.61 * one.duration_s):
            earlier, now, later = (np.array(one.way(t_s + by_s)) for by_s in (-1e-4, 0.0, 1e-4))
            slope = (later - earlier) / 2e-4
            assert slope[:2] == pytest.approx(now[1:], abs=2e-3), one.name


def test_each_manoeuvre_begins_where_and_as_fast_as_the_one_before_ends() -> None:
    steps = {Name.HEIGHT_STEP, Name.HEIGHT_BACK, Name.POSITION_STEP, Name.POSITION_BACK}
    for one in MANOEUVRES[1:]:
        begin_s, _ = span_s(one.name)
        before, after = np.array(wish_at(begin_s - 1e-6)), np.array(wish_at(begin_s + 1e-6))
        assert after[1] == pytest.approx(before[1], abs=1e-4), one.name
        assert np.allclose(after[0], before[0], atol=1e-4) is (one.name not in steps), one.name


def test_a_late_drone_is_behind_by_its_speed_times_the_delay(late: dict[str, float]) -> None:
    assert late["at 5 m/s: behind in the end m"] == pytest.approx(5.0 * LATE_S, abs=1e-3)
    assert late["circle of 20 m at 5 m/s: behind m"] == pytest.approx(5.0 * LATE_S, abs=1e-3)
    assert late["circle of 20 m at 5 m/s: outward m"] == pytest.approx(0.0, abs=1e-3)


def test_a_late_drone_rises_late_and_overshoots_nothing(late: dict[str, float]) -> None:
    assert late["position step: 63 % after s"] == pytest.approx(LATE_S, abs=0.02)
    assert late["position step: overshoot m"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
def test_the_law_of_a_stand_in_is_that_of_its_parameters() -> None:
    law = fit_law(fly_stand_in("ardupilot", {}))
    assert law.lag_s == pytest.approx(0.15, abs=0.04)  # ATC_INPUT_TC, and turn rates that lag besides
    assert law.drag_per_s == pytest.approx(0.4, abs=0.05)  # 0.248 of the rotors and 0.03 per metre, at 5 m/s
    assert law.delay_s == pytest.approx(0.0, abs=0.02)  # a path that is carried on is held by nobody
    assert law.rms_m < 0.05


def test_the_circle_turns_about_a_centre_beside_its_begin() -> None:
    begin_s, end_s = span_s(Name.CIRCLE)
    centre = np.add(wish_at(begin_s)[0], (0.0, CIRCLE_RADIUS_M, 0.0))
    away_m = [np.linalg.norm(np.array(wish_at(t)[0]) - centre) for t in np.linspace(begin_s, end_s - 0.01, 9)]
    assert away_m == pytest.approx([CIRCLE_RADIUS_M] * 9)


def test_a_silent_endpoint_is_told() -> None:
    pilot = Pilot("udpin:127.0.0.1:1")
    pilot.poll(1_000_000_000)
    with pytest.raises(UserError, match="no heartbeat"):
        pilot.poll(100_000_000_000)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ((), "--mavlink"),
        (("--firmware", "betaflight"), "px4, ardupilot"),
        (("--firmware", "px4", "--parameter", "MPC_XY_P"), "NAME=VALUE"),
        (("--firmware", "px4", "--parameter", "MPC_XY_Q=1"), "MPC_XY_Q"),
    ],
)
def test_what_cannot_be_flown_is_said_in_one_line(arguments: tuple[str, ...], told: str) -> None:
    result = CliRunner().invoke(app, ["identify", *arguments])
    assert isinstance(result.exception, UserError)
    text = str(result.exception)
    assert told in text
    assert "\n" not in text


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--firmware", "inav"], "no stand-in for 'inav'"),
        (["--parameter", "NOPE=1"], "no parameter NOPE"),
        (["--firmware", "px4", "--parameter", "MPC_XY_P=1e9"], "MPC_XY_P = 1000000000.0 is not between"),
        (["--parameter", "WPNAV_SPEED=500"], "has no known form"),  # of ArduPilot, which may be there
    ],
)
def test_what_the_stand_in_cannot_be_is_told_before_an_autopilot_is_met(options: list[str], told: str) -> None:
    result = CliRunner().invoke(app, ["identify", "--mavlink", "foo", *options])
    assert isinstance(result.exception, UserError)
    assert told in str(result.exception)
