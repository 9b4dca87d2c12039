"""The autopilot's error about itself: its statistics, and that it both reports and flies by it."""

import numpy as np
import pytest

from sim_autopilot.control.parameters import ControllerKind
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.own_state import NO_ERROR, OwnStateError, OwnStateModel
from sim_autopilot.plant.plant import fly
from tests.sim_autopilot.flights import CALM, DT_S, holding, hovering
from tests.sim_autopilot.pilot import Pilot, px4, setpoint

STEP_S = 0.01
MODEL = OwnStateModel(seed=3, position_std_m=0.5, velocity_std_m_s=0.1, position_time_s=1.0, velocity_time_s=0.2)
STEP_ENU_M = (3.0, -4.0, 0.0)


@pytest.mark.slow
def test_error_has_its_variance_and_its_correlation() -> None:
    error = OwnStateError(MODEL, STEP_S)
    values = np.array([error.advance() for _ in range(200_000)])
    np.testing.assert_allclose(values.std(axis=0), [0.5] * 3 + [0.1] * 3, rtol=0.12)
    for columns, time_s in ((slice(0, 3), 1.0), (slice(3, 6), 0.2)):
        for part in (0.5, 1.0, 2.0):
            lag, series = round(part * time_s / STEP_S), values[:, columns]
            correlation = (series[lag:] * series[:-lag]).mean() / (series**2).mean()
            assert correlation == pytest.approx((1.0 + part) * np.exp(-part), abs=0.05)


@pytest.mark.slow
def test_error_is_stationary_from_its_first_value() -> None:
    firsts = [OwnStateError(OwnStateModel(seed=seed, position_std_m=0.5), STEP_S).advance() for seed in range(1000)]
    np.testing.assert_allclose(np.std(firsts, axis=0), [0.5] * 3 + [0.0] * 3, rtol=0.08)


def test_height_may_be_known_worse_than_the_rest_of_the_place() -> None:
    models = [OwnStateModel(seed=seed, position_std_m=0.1, height_std_m=0.6) for seed in range(300)]
    firsts = [OwnStateError(model, STEP_S).advance() for model in models]
    np.testing.assert_allclose(np.std(firsts, axis=0), [0.1, 0.1, 0.6, 0.0, 0.0, 0.0], rtol=0.15)


def test_error_is_smooth() -> None:
    error = OwnStateError(OwnStateModel(seed=4, position_std_m=0.5, position_time_s=10.0), STEP_S)
    values = np.array([error.advance() for _ in range(2000)])
    # Its rate is std / T = 0.05 m/s on each axis; five of that in a step.
    assert np.abs(np.diff(values[:, :3], axis=0)).max() < 5.0 * 0.05 * STEP_S


def test_autopilot_without_errors_knows_the_truth() -> None:
    error = OwnStateError(OwnStateModel(), STEP_S)
    assert all(error.advance() is NO_ERROR for _ in range(5))


@pytest.mark.parametrize("kind", [ControllerKind.GEOMETRIC, ControllerKind.LQR_FEEDFORWARD])
def test_controller_holds_the_place_that_it_believes_in(kind: ControllerKind) -> None:
    config = PlantConfig(controller=kind)
    drone, error = hovering(config, (0.0, 0.0, 10.0)), np.array([0.4, -0.3, 0.2, 0.0, 0.0, 0.0])
    for _ in range(1000):
        drone = fly(drone, holding((1.0, 2.0, 10.0)), None, CALM, config, DT_S, error)
    np.testing.assert_allclose(drone.state.position_enu_m, (0.6, 2.3, 9.8), atol=0.01)


@pytest.mark.slow
def test_telemetry_tells_what_the_autopilot_believes() -> None:
    pilot = Pilot(px4(own_state=MODEL))
    pilot.take_off(5.0)
    errors_m = []
    for _ in range(400):
        pilot.step(setpoint((0.0, 0.0, -5.0)))
        message, (east, north, up) = pilot.last("LOCAL_POSITION_NED"), pilot.position
        errors_m.append((message.y - east, message.x - north, -message.z - up))
    assert 0.1 < np.std(errors_m) < 1.0
    assert pilot.node.memory.places.origin.resets == 0


@pytest.mark.slow
def test_origin_steps_once_under_a_drone_that_stays() -> None:
    pilot = Pilot(px4(own_state=OwnStateModel(origin_step_enu_m=STEP_ENU_M, origin_step_s=12.0)))
    pilot.take_off(5.0)
    while pilot.t_s < 11.9:
        pilot.step(setpoint((0.0, 0.0, -5.0)))
    before, place, first = pilot.last("LOCAL_POSITION_NED"), pilot.position.copy(), pilot.last("GPS_GLOBAL_ORIGIN")
    while pilot.t_s < 12.1:  # the old setpoint is held, and moves with the frame; nothing asks for another one
        pilot.step()
    after, moved = pilot.last("LOCAL_POSITION_NED"), pilot.last("GPS_GLOBAL_ORIGIN")
    assert (after.y - before.y, after.x - before.x) == pytest.approx((-3.0, 4.0), abs=0.2)
    assert np.linalg.norm(pilot.position - place) < 0.2
    # 111.2 km a degree of latitude, 1e-7 degrees a unit
    assert (moved.latitude - first.latitude) * 1e-7 * 111_250.0 == pytest.approx(-4.0, abs=0.05)
    assert pilot.last("ODOMETRY").reset_counter == 1
    while pilot.t_s < 12.9:
        pilot.step()
    assert pilot.position[0] > place[0] + 0.3  # PX4 follows the coordinates that it was given
