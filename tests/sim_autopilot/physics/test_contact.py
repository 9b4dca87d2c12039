import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.records import replace
from sim_autopilot.core.data import Deck, Surface
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, GRAVITY_M_S2, REPORT_AIRFRAME
from sim_autopilot.physics.contact import GEAR_HEIGHT_M
from sim_autopilot.physics.ground_effect import thrust_gain
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.plant import PlantMemory, fly
from tests.sim_autopilot.flights import CALM, at_rest, driving, flown, going, holding, hovering

CONFIG = PlantConfig()
STILL = PlantConfig(airframe=REPORT_AIRFRAME)
ROOF_M = 1.5
ON_ROOF = (0.0, 0.0, ROOF_M + GEAR_HEIGHT_M)
OFF = None


def moving(memory: PlantMemory, velocity: object, spin: object = (0.0, 0.0, 0.0)) -> PlantMemory:
    state = replace(
        memory.state,
        velocity_enu_m_s=np.array(velocity, dtype=np.float64),
        angular_velocity_flu_rad_s=np.array(spin, dtype=np.float64),
    )
    return replace(memory, state=state)


def energy_j(memory: PlantMemory) -> float:
    """Of motion and height; the springs hold some of it now and then, never more than there was."""
    state = memory.state
    spinning = np.array(REPORT_AIRFRAME.inertia_kg_m2) @ state.angular_velocity_flu_rad_s**2
    moving_j = 0.5 * (REPORT_AIRFRAME.mass_kg * state.velocity_enu_m_s @ state.velocity_enu_m_s + spinning)
    return float(moving_j + REPORT_AIRFRAME.weight_n * state.position_enu_m[2])


def test_drone_at_rest_on_the_ground_is_quiet() -> None:
    flight = flown(CONFIG, at_rest(CONFIG, (3.0, -2.0, GEAR_HEIGHT_M)), lambda _: OFF, 20.0)
    assert set(flight.surface) == {Surface.GROUND}
    assert np.abs(flight.position_m[200:] - flight.position_m[200]).max() < 1e-9
    np.testing.assert_allclose(flight.end.state.specific_force_flu_m_s2, [0, 0, GRAVITY_M_S2], atol=1e-9)


def test_drone_at_rest_sinks_as_far_as_four_springs_give() -> None:
    flight = flown(CONFIG, at_rest(CONFIG, (0, 0, GEAR_HEIGHT_M)), lambda _: OFF, 3.0)
    assert GEAR_HEIGHT_M - flight.position_m[-1, 2] == pytest.approx(REPORT_AIRFRAME.weight_n / 8000.0, rel=1e-6)


def test_wind_of_10_m_s_does_not_move_a_standing_drone() -> None:
    flight = flown(
        CONFIG,
        at_rest(CONFIG, (0, 0, GEAR_HEIGHT_M)),
        lambda _: OFF,
        20.0,
        wind_at=lambda _: np.array([8.0, -6.0, 0.0]),
    )
    assert np.abs(flight.position_m[200:] - flight.position_m[200]).max() < 1e-9
    assert np.linalg.norm(flight.position_m[-1, :2]) < 1e-3


@pytest.mark.parametrize("sink_m_s", [0.3, 1.0, 2.0])
def test_touchdown_bounces_less_than_two_centimetres(sink_m_s: float) -> None:
    start = moving(at_rest(CONFIG, (0, 0, GEAR_HEIGHT_M + 0.001)), (0, 0, -sink_m_s))
    flight = flown(CONFIG, start, lambda _: OFF, 2.0)
    touched = flight.surface.index(Surface.GROUND)
    assert flight.position_m[touched:, 2].max() < GEAR_HEIGHT_M + 0.02
    assert flight.position_m[:, 2].min() > GEAR_HEIGHT_M - 0.03


@pytest.mark.slow
@given(
    st.tuples(*[st.floats(-4, 4)] * 2, st.floats(-6, 0)),
    st.tuples(*[st.floats(-6, 6)] * 3),
    st.floats(0.0, 2.5),
)
@settings(max_examples=40, deadline=None)
def test_crashes_never_gain_energy(velocity: tuple[float, ...], spin: tuple[float, ...], lean: float) -> None:
    start = at_rest(STILL, (0, 0, 0.8))
    tilted = replace(
        start.state,
        orientation_wxyz=np.array([math.cos(lean / 2), 0.6 * math.sin(lean / 2), 0.8 * math.sin(lean / 2), 0.0]),
    )
    memory = moving(replace(start, state=tilted), velocity, spin)
    bound = energy_j(memory)
    for _ in range(300):
        memory = fly(memory, OFF, None, CALM, STILL, 0.01)
        assert energy_j(memory) <= bound + 1e-6 * abs(bound)
    assert energy_j(memory) < 0.9 * bound


def test_drone_stays_on_a_roof_driving_at_10_m_s() -> None:
    deck_at = driving(10.0, yaw=0.7)
    velocity = deck_at(0.0).velocity_enu_m_s
    flight = flown(CONFIG, moving(at_rest(CONFIG, ON_ROOF, 0.2), velocity), lambda _: OFF, 5.0, deck_at=deck_at)
    under = deck_at(flight.t_s[-1]).position_enu_m
    assert np.linalg.norm((flight.position_m[-1] - under)[:2]) < 0.01
    assert flight.surface[-1] is Surface.DECK


def test_drone_turns_with_a_roof_that_turns() -> None:
    rate = 0.4

    def deck_at(t_s: float) -> Deck:
        yaw = rate * t_s
        deck = driving(0.0, yaw=yaw)(t_s)
        return replace(deck, angular_velocity_enu_rad_s=np.array([0.0, 0.0, rate]))

    start = moving(at_rest(CONFIG, (1.0, 0.0, ON_ROOF[2])), (0.0, rate, 0.0), (0.0, 0.0, rate))
    flight = flown(CONFIG, start, lambda _: OFF, 5.0, deck_at=deck_at)
    expected = np.array([math.cos(2.0), math.sin(2.0)])
    np.testing.assert_allclose(flight.position_m[-1, :2], expected, atol=0.01)
    assert flight.yaw_rad[-1] == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize(("friction", "slides"), [(0.8, False), (0.3, True)])
def test_braking_at_6_m_s2_throws_off_only_what_friction_cannot_hold(friction: float, slides: bool) -> None:
    config = PlantConfig(friction_coefficient=friction)

    def deck_at(t_s: float) -> Deck:
        braking = min(t_s, 10.0 / 6.0)
        speed = 10.0 - 6.0 * braking
        along = 10.0 * braking - 3.0 * braking**2
        deck = driving(0.0)(t_s)
        return replace(deck, position_enu_m=np.array([along, 0, 0]), velocity_enu_m_s=np.array([speed, 0.0, 0.0]))

    flight = flown(config, moving(at_rest(config, ON_ROOF), (10.0, 0, 0)), lambda _: OFF, 1.5, deck_at=deck_at)
    slid = float(flight.position_m[-1, 0] - deck_at(1.5).position_enu_m[0])
    assert (slid > 0.5) is slides
    assert slides or slid < 0.02


def test_sliding_slows_down_by_coulombs_law() -> None:
    config = PlantConfig(airframe=REPORT_AIRFRAME, friction_coefficient=0.3)
    flight = flown(config, moving(at_rest(config, (0, 0, GEAR_HEIGHT_M - 0.0018)), (5.0, 0, 0)), lambda _: OFF, 1.0)
    assert flight.velocity_m_s[-1, 0] == pytest.approx(5.0 - 0.3 * GRAVITY_M_S2, rel=0.01)


def test_roof_that_strikes_from_the_side_is_a_flank_and_pushes_the_drone_along() -> None:
    deck_at = driving(5.0)
    flight = flown(CONFIG, hovering(CONFIG, (3.0, 0.2, 0.7)), lambda _: holding((3.0, 0.2, 0.7)), 1.0, deck_at=deck_at)
    assert Surface.SIDE in flight.surface
    assert Surface.DECK not in flight.surface
    assert flight.velocity_m_s[:, 0].max() > 3.0


def test_drone_beside_the_roof_falls_to_the_ground() -> None:
    flight = flown(CONFIG, at_rest(CONFIG, (0.0, 1.6, 2.0)), lambda _: OFF, 3.0, deck_at=driving(0.0))
    assert set(flight.surface) == {Surface.NONE, Surface.GROUND}
    assert flight.position_m[-1, 2] == pytest.approx(GEAR_HEIGHT_M, abs=0.003)


def test_drone_half_over_the_edge_tips_off() -> None:
    flight = flown(CONFIG, at_rest(CONFIG, (0.0, 1.0, ON_ROOF[2])), lambda _: OFF, 3.0, deck_at=driving(0.0))
    assert flight.surface[0] is Surface.DECK
    assert flight.surface[-1] is Surface.GROUND
    assert flight.position_m[-1, 2] < 0.5


def test_pad_on_the_road_has_no_flanks() -> None:
    deck_at = driving(4.0, height_m=0.0, size_m=(1.5, 1.5))
    flight = flown(CONFIG, at_rest(CONFIG, (3.0, 0, GEAR_HEIGHT_M)), lambda _: OFF, 2.0, deck_at=deck_at)
    assert {Surface.GROUND, Surface.DECK} == set(flight.surface)
    assert np.abs(flight.position_m[:, 2] - GEAR_HEIGHT_M).max() < 0.01


def test_drone_upside_down_rests_on_its_rotors() -> None:
    start = at_rest(CONFIG, (0, 0, 0.3))
    start = replace(start, state=replace(start.state, orientation_wxyz=np.array([0.0, 1.0, 0.0, 0.0])))
    flight = flown(CONFIG, start, lambda _: OFF, 3.0)
    assert flight.position_m[-1, 2] == pytest.approx(0.0, abs=0.003)
    assert np.linalg.norm(flight.velocity_m_s[-1]) < 1e-6


def test_ground_effect_is_cheesemans_and_bennetts_and_bounded() -> None:
    assert thrust_gain.py_func(0.127, 0.127, 0.0, 5.5) == pytest.approx(1.0 / (1.0 - 1.0 / 16.0))
    assert thrust_gain.py_func(0.01, 0.127, 0.0, 5.5) == pytest.approx(4.0 / 3.0)
    assert thrust_gain.py_func(1.5, 0.127, 0.0, 5.5) == 1.0
    assert thrust_gain.py_func(0.127, 0.127, 20.0, 5.5) < 1.005


@pytest.mark.parametrize("on", [True, False])
def test_ground_effect_lets_the_rotors_turn_slower_over_a_roof(on: bool) -> None:
    config = PlantConfig(ground_effect=on)
    low = (0.0, 0.0, ROOF_M + 0.2)
    flight = flown(config, hovering(config, low), lambda _: holding(low), 6.0, deck_at=driving(0.0))
    slower = flight.end.state.rotor_speed_rad_s.mean() / BENCHMARK_AIRFRAME.hover_speed_rad_s
    gain = thrust_gain.py_func(0.2, 0.127, 0.0, 5.5) if on else 1.0
    assert slower == pytest.approx(1.0 / math.sqrt(gain), abs=1e-4)
    assert flight.position_m[-1, 2] == pytest.approx(low[2], abs=1e-3)


@pytest.mark.parametrize("speed_m_s", [0.0, 10.0])
def test_landing_under_control_stays_on_the_roof_after_motors_off(speed_m_s: float) -> None:
    deck_at = driving(speed_m_s)

    def sinking(t_s: float) -> object:
        along = deck_at(t_s).position_enu_m[0]
        return going((along, 0, ON_ROOF[2] + 1.0 - 0.5 * t_s), (speed_m_s, 0, -0.5), (0, 0, 0))

    start = hovering(CONFIG, (0, 0, ON_ROOF[2] + 1.0), velocity=(speed_m_s, 0, 0))
    landing = flown(CONFIG, start, sinking, 3.5, deck_at=deck_at)  # type: ignore[arg-type]  # `going` tells no type
    after = flown(
        CONFIG,
        landing.end,
        lambda _: OFF,
        3.0,
        deck_at=lambda t: replace(deck_at(t + 3.5), t_ns=round((t + 3.5) * 1e9)),
    )
    assert landing.surface[-1] is Surface.DECK
    assert after.surface[-1] is Surface.DECK
    assert np.linalg.norm((after.position_m[-1] - deck_at(6.5).position_enu_m)[:2]) < 0.15
