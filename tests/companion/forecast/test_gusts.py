"""How strong the gusts are is learnt from what pushes the drone, not from what its path or its lean does."""

import math

import numpy as np
import pytest

from companion.autopilots.response import (
    ATTITUDE_LAG_S,
    DRAG_PER_S,
    POSITION_STD_M,
    PUSH_STD_M_S2,
    VELOCITY_STD_M_S,
    Cascade,
    ResponseModel,
)
from companion.core.data import Array
from companion.forecast.gusts import Gusts, forget_push, update_gusts

RESPONSE = ResponseModel(
    Cascade(position_per_s=0.95, velocity_per_s=1.8, integral_per_s2=0.4, lead_s=0.02), np.arange(0.0, 4.01, 0.2)
)
REPORT_S = 0.02


def learnt(pushes_m_s2: Array, path_m_s2: float = 0.0) -> Gusts:
    """What reports teach in which the estimated push (n, 2) is this."""
    gusts = Gusts()
    for report, push in enumerate(pushes_m_s2):
        deviation = np.zeros((4, 2))
        deviation[3] = push
        gusts = update_gusts(gusts, round(report * REPORT_S * 1e9), deviation, np.full(2, path_m_s2), RESPONSE)
    return gusts


def pushed(std_m_s2: float, noise: float, seed: int, drones: int = 1) -> list[Gusts]:
    """What is learnt over two minutes from the reports of drones that are pushed so, with that share of their noise."""
    rng, axes, forgets_hz = np.random.default_rng(seed), 2 * drones, RESPONSE.cascade.forgets_hz
    truth, state, gusts = np.zeros((4, axes)), np.zeros((4, axes)), [Gusts()] * drones
    new_m_s2 = std_m_s2 * math.sqrt(1.0 - math.exp(-2.0 * REPORT_S * forgets_hz))
    errs, still = noise * np.array([[POSITION_STD_M], [VELOCITY_STD_M_S]]), np.zeros(axes)
    for report in range(6000):
        truth = RESPONSE.carry(truth, still, REPORT_S)
        truth[3] += new_m_s2 * rng.standard_normal(axes)
        state = RESPONSE.update(state, truth[:2] + errs * rng.standard_normal((2, axes)), still, REPORT_S)
        of_each, reported_ns = np.split(state, drones, axis=1), round(report * REPORT_S * 1e9)
        gusts = [
            update_gusts(one, reported_ns, own, np.zeros(2), RESPONSE) for one, own in zip(gusts, of_each, strict=True)
        ]
    return gusts


@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize("std_m_s2", [0.3, 0.75, 1.5])
def test_gusts_are_learnt_from_what_pushes_whatever_the_reports_noise(std_m_s2: float, noise: float) -> None:
    found = np.mean([gusts.push_std_m_s2**2 for gusts in pushed(std_m_s2, noise, 1, drones=4)]) ** 0.5
    assert found == pytest.approx(std_m_s2, rel=0.25, abs=0.12)


def test_push_that_is_estimated_anew_is_no_gust() -> None:
    before, nothing = learnt(np.full((75, 2), 5.0)), np.zeros((4, 2))
    gusts, anew = before, forget_push(before)
    for report in range(75, 200):
        t_ns = round(report * REPORT_S * 1e9)
        gusts, anew = (update_gusts(one, t_ns, nothing, np.zeros(2), RESPONSE) for one in (gusts, anew))
    assert gusts.push_std_m_s2 > before.push_std_m_s2 > anew.push_std_m_s2


def test_reports_without_noise_of_a_drone_that_nothing_pushes_show_no_gusts() -> None:
    assert Gusts().push_std_m_s2 == pytest.approx(0.8 * DRAG_PER_S)  # a gentle breeze
    (gusts,) = pushed(0.0, 0.0, 1)
    assert gusts.push_std_m_s2 < 0.3 * PUSH_STD_M_S2


def test_what_the_integrator_still_holds_after_a_hard_flight_is_no_gust() -> None:
    times_s = REPORT_S * np.arange(1000)
    left = np.exp(-times_s * RESPONSE.cascade.forgets_hz)
    assert learnt(1.2 * np.column_stack([left, -left])).push_std_m_s2 < 0.3 * PUSH_STD_M_S2


def test_what_drag_does_to_a_path_that_speeds_up_is_no_gust() -> None:
    path_m_s2, forgets_hz = 2.0, RESPONSE.cascade.forgets_hz
    held = -DRAG_PER_S * path_m_s2 / forgets_hz * (1.0 - np.exp(-REPORT_S * np.arange(500) * forgets_hz))
    assert learnt(np.column_stack([held, held]), path_m_s2).push_std_m_s2 < 0.35 * PUSH_STD_M_S2


def flown(lag_s: float, std_m_s2: float, seed: int) -> Gusts:
    """What is learnt in a minute of a path that speeds up and slows down by 3 m/s^2, with a lean of another lag."""
    rng, gusts, gains = np.random.default_rng(seed), Gusts(), RESPONSE.cascade
    forgets_hz, model = gains.forgets_hz, np.zeros((4, 2))
    place, rate, lean, push, path = np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2), np.zeros(2)
    for report in range(3000):
        wanted = 3.0 if report // 100 % 2 else -3.0
        path = path + np.clip(wanted - path, -10.0 * REPORT_S, 10.0 * REPORT_S)
        lean = lean + (path - gains.velocity_per_s * (rate + gains.position_per_s * place) - lean) * (REPORT_S / lag_s)
        push = push - (forgets_hz * push + DRAG_PER_S * path) * REPORT_S
        push += std_m_s2 * math.sqrt(2.0 * REPORT_S * forgets_hz) * rng.standard_normal(2)
        rate = rate + (lean + push - path) * REPORT_S
        place = place + rate * REPORT_S
        model = RESPONSE.update(model, np.stack((place, rate)), path, REPORT_S)
        gusts = update_gusts(gusts, round(report * REPORT_S * 1e9), model, path, RESPONSE)
    return gusts


def test_a_lean_that_lags_by_half_as_much_again_is_no_gust() -> None:
    found = flown(RESPONSE.cascade.attitude_lag_s + 0.5 * ATTITUDE_LAG_S, 0.0, 1)
    assert found.push_std_m_s2 < 0.3 * PUSH_STD_M_S2


def test_gusts_are_learnt_on_a_path_of_much_jerk_too() -> None:
    found = np.mean([flown(RESPONSE.cascade.attitude_lag_s, 1.0, seed).push_std_m_s2 ** 2 for seed in range(4)]) ** 0.5
    assert found == pytest.approx(1.0, rel=0.3)
