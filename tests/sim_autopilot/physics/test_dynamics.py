import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from link.records import replace
from sim_autopilot.core.data import Array
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, GRAVITY_M_S2, REPORT_AIRFRAME
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.plant import PlantMemory, fly
from tests.sim_autopilot.flights import CALM, at_rest, flown, holding, hovering

WIND = np.array([4.0, -2.0, 1.0])
SPIN = np.array([1.3, -2.1, 0.7])


def tumbling(config: PlantConfig, speeds: tuple[float, float, float, float]) -> PlantMemory:
    memory = at_rest(config, (1.0, -2.0, 500.0), yaw=0.4)
    state = replace(
        memory.state,
        orientation_wxyz=Rotation.from_euler("ZYX", [0.4, -0.3, 0.25]).as_quat(canonical=True)[[3, 0, 1, 2]],
        velocity_enu_m_s=np.array([5.0, -1.0, 2.0]),
        angular_velocity_flu_rad_s=SPIN,
        rotor_speed_rad_s=np.array(speeds),
    )
    return replace(memory, state=state)


def body_rate(t_s: float, x: Array, start: Array) -> Array:
    """The report's eqs. 2-5 with drag, written again: rotation from scipy, allocation as a matrix, motors stopping."""
    airframe = BENCHMARK_AIRFRAME
    kt, kd, d = airframe.thrust_coefficient_n_s2, airframe.torque_coefficient_n_m_s2, airframe.arm_m
    square = (start * np.exp(-t_s / 0.05)) ** 2
    allocation = np.array(
        [[kt] * 4, [0, 0, -d * kt, d * kt], [d * kt, -d * kt, 0, 0], [kd, kd, -kd, -kd]], dtype=np.float64
    )
    thrust, *torque = allocation @ square
    inertia = np.diag(airframe.inertia_kg_m2)
    R = Rotation.from_quat(x[[4, 5, 6, 3]]).as_matrix()
    w = x[10:13]
    acceleration = (R[:, 2] * thrust - airframe.drag_n_s_m * (x[7:10] - WIND)) / airframe.mass_kg
    scalar = -0.5 * x[4:7] @ w
    vector = 0.5 * (x[3] * w + np.cross(x[4:7], w))
    turning = np.linalg.solve(inertia, np.array(torque) - np.cross(w, inertia @ w))
    return np.concatenate([x[7:10], [scalar], vector, acceleration - [0, 0, GRAVITY_M_S2], turning])


def test_flight_agrees_with_scipy_integrating_the_same_equations() -> None:
    config = PlantConfig()
    memory = tumbling(config, (900.0, 700.0, 500.0, 800.0))
    start = memory.state
    x0 = np.concatenate([start.position_enu_m, start.orientation_wxyz, start.velocity_enu_m_s, SPIN])
    expected = solve_ivp(
        body_rate, (0.0, 1.0), x0, args=(start.rotor_speed_rad_s,), rtol=1e-11, atol=1e-12, method="DOP853"
    ).y[:, -1]
    end = flown(config, memory, lambda _: None, 1.0, wind_at=lambda _: WIND).end.state
    np.testing.assert_allclose(end.position_enu_m, expected[0:3], atol=1e-8)
    np.testing.assert_allclose(end.velocity_enu_m_s, expected[7:10], atol=1e-8)
    np.testing.assert_allclose(end.angular_velocity_flu_rad_s, expected[10:13], atol=1e-7)
    expected_q = expected[3:7] * np.sign(expected[3])
    np.testing.assert_allclose(end.orientation_wxyz, expected_q / np.linalg.norm(expected_q), atol=1e-8)


def test_free_spin_conserves_angular_momentum_and_energy() -> None:
    config = PlantConfig(airframe=REPORT_AIRFRAME)
    inertia = np.array(REPORT_AIRFRAME.inertia_kg_m2)

    def momentum(memory: PlantMemory) -> Array:
        rotation = Rotation.from_quat(memory.state.orientation_wxyz[[1, 2, 3, 0]])
        return np.asarray(rotation.apply(inertia * memory.state.angular_velocity_flu_rad_s))

    def energy(memory: PlantMemory) -> float:
        return float(0.5 * inertia @ memory.state.angular_velocity_flu_rad_s**2)

    start = tumbling(config, (0.0, 0.0, 0.0, 0.0))
    end = flown(config, start, lambda _: None, 5.0).end
    np.testing.assert_allclose(momentum(end), momentum(start), rtol=1e-9, atol=1e-12)
    assert energy(end) == pytest.approx(energy(start), rel=1e-9)


def test_quaternion_stays_of_unit_length_and_positive_through_full_turns() -> None:
    config = PlantConfig()
    memory = tumbling(config, (0.0, 0.0, 0.0, 0.0))
    for _ in range(500):
        memory = fly(memory, None, None, CALM, config, 0.01)
        assert np.linalg.norm(memory.state.orientation_wxyz) == pytest.approx(1.0, abs=1e-12)
        assert memory.state.orientation_wxyz[0] >= 0.0


def test_fall_with_linear_drag_follows_its_closed_form() -> None:
    config = PlantConfig()
    end = flown(config, at_rest(config, (0.0, 0.0, 300.0)), lambda _: None, 4.0).end.state
    rate = BENCHMARK_AIRFRAME.drag_n_s_m / BENCHMARK_AIRFRAME.mass_kg
    terminal = GRAVITY_M_S2 / rate
    assert end.velocity_enu_m_s[2] == pytest.approx(-terminal * (1.0 - np.exp(-4.0 * rate)), rel=1e-9)


def test_accelerometer_reads_nothing_in_free_fall() -> None:
    config = PlantConfig(airframe=REPORT_AIRFRAME)
    end = flown(config, at_rest(config, (0.0, 0.0, 300.0)), lambda _: None, 1.0).end.state
    np.testing.assert_allclose(end.specific_force_flu_m_s2, 0.0, atol=1e-12)


def test_accelerometer_reads_gravity_in_hover() -> None:
    config = PlantConfig()
    end = flown(config, hovering(config, (0, 0, 9)), lambda _: holding((0, 0, 9)), 3.0).end.state
    np.testing.assert_allclose(end.specific_force_flu_m_s2, [0.0, 0.0, GRAVITY_M_S2], atol=1e-6)


def test_hover_speed_of_the_report_is_742_rad_s() -> None:
    assert REPORT_AIRFRAME.hover_speed_rad_s == pytest.approx(742.7, abs=0.05)
