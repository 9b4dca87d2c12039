"""The air at a drone: the wind's far away, and behind a superstructure as slow and as rough as its wake."""

import numpy as np
import pytest

from link.records import replace
from sim_autopilot.air.air import Air
from sim_autopilot.air.airflow import TURBULENCE, Obstacle
from sim_autopilot.air.wind import Turbulence, WindModel
from sim_autopilot.core.data import Array, Deck, PlantState
from sim_autopilot.plant.config import PlantConfig
from tests.sim_autopilot.flights import driving, hovering

DT_S = 0.01
HANGAR = Obstacle(length_m=20.0, width_m=13.7, height_m=6.1, ahead_m=20.0, foot_m=6.5)
SPEED_M_S = 8.0


def wind(mean_m_s: float = 0.0, turbulence: Turbulence = Turbulence.NONE) -> WindModel:
    return WindModel(3, mean_m_s, 0.0, turbulence)


def deck_at(*, speed_m_s: float = SPEED_M_S, yaw_rad: float = 0.0) -> Deck:
    """A ship's deck over the origin that drives where it heads."""
    ahead = np.array([np.cos(yaw_rad), np.sin(yaw_rad), 0.0])
    return replace(
        driving()(0.0),
        position_enu_m=np.zeros(3),
        velocity_enu_m_s=speed_m_s * ahead,
        orientation_wxyz=np.array([np.cos(0.5 * yaw_rad), 0.0, 0.0, np.sin(0.5 * yaw_rad)]),
        roof_size_m=(20.0, 17.0),
        roof_height_m=6.5,
    )


def drone_at(height_m: float) -> PlantState:
    return hovering(PlantConfig(), (0.0, 0.0, height_m)).state


def blown(air: Air, drone: PlantState, deck: Deck | None, seconds: float) -> Array:
    return np.array([air.advance(DT_S, drone, deck) for _ in range(round(seconds / DT_S))])


def test_air_without_a_vehicle_is_the_wind() -> None:
    alone, air = wind(6.0, Turbulence.MODERATE), Air(wind(6.0, Turbulence.MODERATE), 1)
    drone, past_m_s = drone_at(5.0), np.zeros(3)
    for _ in range(20):
        past_m_s = alone.advance(DT_S, float(np.linalg.norm(drone.velocity_enu_m_s - past_m_s)))
        np.testing.assert_allclose(air.advance(DT_S, drone, None), past_m_s)


def test_vehicle_that_stands_in_calm_air_leaves_it_calm() -> None:
    assert not blown(Air(wind(), 1, HANGAR), drone_at(7.0), deck_at(speed_m_s=0.0), 1.0).any()


@pytest.mark.parametrize("yaw_rad", [0.0, 2.0])
def test_ship_takes_along_the_air_over_its_deck(yaw_rad: float) -> None:
    deck = deck_at(yaw_rad=yaw_rad)
    air = blown(Air(wind(), 1, HANGAR), drone_at(6.7), deck, 600.0)
    np.testing.assert_allclose(air.mean(axis=0), deck.velocity_enu_m_s, atol=0.1 * SPEED_M_S)
    np.testing.assert_allclose(air.std(axis=0), TURBULENCE * SPEED_M_S, rtol=0.1)


def test_eddies_of_a_wake_last_as_long_as_the_stream_takes_over_the_hangars_height() -> None:
    air = blown(Air(wind(), 1, HANGAR), drone_at(6.7), deck_at(), 600.0)
    air -= air.mean(axis=0)
    later = round(HANGAR.height_m / SPEED_M_S / DT_S)
    kept = (air[:-later] * air[later:]).mean(axis=0) / air.var(axis=0)
    np.testing.assert_allclose(kept, np.exp(-1.0), atol=0.1)


def test_air_over_the_hangar_is_the_wind_but_for_a_little() -> None:
    air = blown(Air(wind(5.0), 1, HANGAR), drone_at(16.0), deck_at(), 10.0)
    assert (air.std(axis=0) < 1e-9).all()
    np.testing.assert_allclose(air[0], (5.0, 0.0, 0.0), atol=0.5)


def test_same_seed_is_the_same_air_and_another_seed_another() -> None:
    first, again, other = (blown(Air(wind(), seed, HANGAR), drone_at(7.0), deck_at(), 1.0) for seed in (4, 4, 5))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.1


def test_without_a_superstructure_the_body_itself_is_in_the_wind() -> None:
    deck = replace(deck_at(), roof_size_m=(4.2, 1.8), roof_height_m=1.5)
    over = blown(Air(wind(), 1), drone_at(1.7), deck, 0.1)
    assert over[0, 0] == pytest.approx(-0.17 * SPEED_M_S, abs=0.03 * SPEED_M_S)
    on_the_road = replace(deck, roof_height_m=0.0)
    assert not blown(Air(wind(), 1), drone_at(1.7), on_the_road, 0.1).any()


def test_vehicle_has_driven_on_since_its_report() -> None:
    now = replace(deck_at(), t_ns=drone_at(0.0).t_ns)
    behind = drone_at(2.0)  # a steep change along the road, at the edge of the roof
    behind = replace(behind, position_enu_m=np.array([-8.0, 0.0, 7.0]))
    late = replace(now, t_ns=now.t_ns - 50_000_000, position_enu_m=-0.05 * now.velocity_enu_m_s)
    same, other = (blown(Air(wind(), 1, HANGAR), behind, deck, 0.1) for deck in (now, late))
    np.testing.assert_allclose(same, other, rtol=1e-12)
    stale = blown(Air(wind(), 1, HANGAR), behind, replace(late, t_ns=now.t_ns), 0.1)
    assert np.abs(stale - same).max() > 0.01
