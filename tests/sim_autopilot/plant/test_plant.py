import importlib
import math
import pkgutil
from dataclasses import dataclass

import numpy as np
import pytest

import sim_autopilot.control
import sim_autopilot.physics
from link.records import replace
from sim_autopilot.control.parameters import ControllerKind
from sim_autopilot.core.data import Array, Reference, Surface
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME, REPORT_AIRFRAME, Airframe
from sim_autopilot.physics.contact import GEAR_HEIGHT_M
from sim_autopilot.plant import kernel as kernel_module
from sim_autopilot.plant import plant as plant_module
from sim_autopilot.plant.config import PlantConfig
from sim_autopilot.plant.plant import PlantMemory, fly, initial_plant
from tests.sim_autopilot.flights import CALM, at_rest, driving, flown, going, holding, hovering

CONFIG = PlantConfig()
WIND = np.array([3.0, -2.0, 0.5])


def interpret(monkeypatch: pytest.MonkeyPatch) -> None:
    """Put the Python that every kernel came from in the kernel's place, in all modules."""
    modules = [kernel_module, plant_module]
    for package in (sim_autopilot.physics, sim_autopilot.control):
        names = [f"{package.__name__}.{entry.name}" for entry in pkgutil.iter_modules(package.__path__)]
        modules += [importlib.import_module(name) for name in names]
    for module in modules:
        for name, value in list(vars(module).items()):
            if hasattr(value, "py_func"):
                monkeypatch.setattr(module, name, value.py_func)


def as_vector(memory: PlantMemory) -> Array:
    state = memory.state
    return np.concatenate(
        [
            state.position_enu_m,
            state.orientation_wxyz,
            state.velocity_enu_m_s,
            state.angular_velocity_flu_rad_s,
            state.rotor_speed_rad_s,
            state.specific_force_flu_m_s2,
            [state.surface.value],
            memory.internals,
        ]
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Journey:
    """A dozen calls from a moving, turning drone near the rim of a moving roof, at 1.5 m."""

    height_m: float
    flying: bool = True
    kind: ControllerKind = ControllerKind.GEOMETRIC
    airframe: Airframe = BENCHMARK_AIRFRAME

    def rows(self, calls: int = 12) -> Array:
        """Return all of the plant (n, m) after each call."""
        config = PlantConfig(controller=self.kind, airframe=self.airframe)
        memory = hovering(config, (1.95, 0.3, self.height_m), 0.2, velocity=(1.0, 0.5, -1.5))
        spinning = replace(memory.state, angular_velocity_flu_rad_s=np.array([0.6, -0.4, 0.3]))
        memory = replace(memory, state=spinning)
        wanted = going((2.0, 1.0, self.height_m + 1.0), (1.0, 0.0, 0.2), (0.1, 0.0, 0.0), 1.0, 0.1)
        deck_at = driving(3.0, yaw=0.3)
        rows = []
        for i in range(calls):
            memory = fly(memory, wanted if self.flying else None, deck_at(0.01 * i), WIND, config, 0.01)
            rows.append(as_vector(memory))
        return np.array(rows)


@pytest.mark.parametrize(
    "journey",
    [
        Journey(height_m=8.0),
        Journey(height_m=8.0, kind=ControllerKind.LQR_FEEDFORWARD),
        Journey(height_m=8.0, kind=ControllerKind.LQR, airframe=REPORT_AIRFRAME),
        Journey(height_m=1.64),
        Journey(height_m=1.63, flying=False),
        Journey(height_m=1.0),
        Journey(height_m=0.1, flying=False),
    ],
    ids=str,
)
def test_every_kernel_equals_its_python(journey: Journey, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = journey.rows()
    interpret(monkeypatch)
    np.testing.assert_allclose(compiled, journey.rows(), rtol=1e-9, atol=1e-9)


def test_fly_leaves_its_arguments_alone() -> None:
    memory = hovering(CONFIG, (0, 0, 1.7))
    before = as_vector(memory).copy()
    reference, deck, wind = holding((1, 2, 3)), driving(2.0)(0.0), WIND.copy()
    fly(memory, reference, deck, wind, CONFIG, 0.01)
    np.testing.assert_array_equal(as_vector(memory), before)
    np.testing.assert_array_equal(wind, WIND)
    assert reference.position_enu_m is not None
    np.testing.assert_array_equal(reference.position_enu_m, [1, 2, 3])


def test_same_flight_is_the_same_bit_for_bit() -> None:
    journey = Journey(height_m=2.0)
    np.testing.assert_array_equal(journey.rows(100), journey.rows(100))


def test_longer_calls_fly_the_same_as_shorter_ones() -> None:
    reference = going((3.0, 0, 9), None, None)
    start = hovering(CONFIG, (0, 0, 9))
    fine = start
    for _ in range(40):
        fine = fly(fine, reference, None, WIND, CONFIG, 0.005)
    np.testing.assert_allclose(as_vector(fly(start, reference, None, WIND, CONFIG, 0.2)), as_vector(fine), atol=1e-12)


def test_time_advances_by_the_duration() -> None:
    memory = initial_plant(CONFIG, 1_790_000_000_123_456_789, np.array([0.0, 0.0, 5.0]), 0.0)
    assert fly(memory, None, None, CALM, CONFIG, 0.01).state.t_ns == 1_790_000_000_133_456_789


@pytest.mark.parametrize("duration_s", [0.0, 0.007, -0.01])
def test_fly_refuses_a_duration_that_is_no_multiple_of_the_period(duration_s: float) -> None:
    with pytest.raises(ValueError, match="duration_s"):
        fly(at_rest(CONFIG, (0, 0, 5)), None, None, CALM, CONFIG, duration_s)


def test_config_refuses_a_period_that_is_no_multiple_of_the_integration_step() -> None:
    with pytest.raises(ValueError, match="control_period_s"):
        PlantConfig(control_period_s=0.0025)


def test_motors_off_in_the_air_fall() -> None:
    flight = flown(CONFIG, hovering(CONFIG, (0, 0, 40)), lambda _: None, 2.0)
    assert flight.velocity_m_s[-1, 2] < -15.0
    assert flight.end.state.rotor_speed_rad_s.max() < 1e-6


def test_motors_on_again_in_the_air_catch_the_drone() -> None:
    fallen = flown(CONFIG, hovering(CONFIG, (0, 0, 60)), lambda _: None, 1.0)
    flight = flown(CONFIG, fallen.end, lambda _: holding((0, 0, 40)), 8.0)
    np.testing.assert_allclose(flight.position_m[-1], [0, 0, 40], atol=0.01)
    assert flight.position_m[:, 2].min() > 30.0


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(ControllerKind))
def test_take_off_from_the_ground_reaches_its_height_upright(kind: ControllerKind) -> None:
    config, yaw = PlantConfig(controller=kind), 0.4
    standing = flown(config, at_rest(config, (2.0, 1.0, GEAR_HEIGHT_M), yaw), lambda _: None, 1.0)

    def climbing(t_s: float) -> Reference:
        return going((2.0, 1.0, GEAR_HEIGHT_M + min(5.0, t_s)), (0, 0, 1.0 if t_s < 5.0 else 0.0), yaw=None)

    flight = flown(config, standing.end, climbing, 15.0)
    np.testing.assert_allclose(flight.position_m[-1], [2.0, 1.0, 5.0 + GEAR_HEIGHT_M], atol=0.02)
    assert flight.tilt_rad.max() < math.radians(5)
    assert flight.position_m[:, 2].max() < 5.0 + GEAR_HEIGHT_M + 0.6


@pytest.mark.parametrize("kind", [ControllerKind.GEOMETRIC, ControllerKind.LQR_FEEDFORWARD])
def test_take_off_from_a_roof_at_8_m_s_keeps_over_it(kind: ControllerKind) -> None:
    config = PlantConfig(controller=kind)
    deck_at = driving(8.0)
    height = 1.5 + GEAR_HEIGHT_M
    start = at_rest(config, (0, 0, height))
    start = replace(start, state=replace(start.state, velocity_enu_m_s=np.array([8.0, 0.0, 0.0])))

    def climbing(t_s: float) -> Reference:
        return going((8.0 * t_s, 0, height + min(4.0, t_s)), (8.0, 0, 1.0 if t_s < 4.0 else 0.0), (0, 0, 0))

    flight = flown(config, start, climbing, 8.0, deck_at=deck_at)
    assert flight.surface[0] is Surface.DECK
    assert Surface.SIDE not in flight.surface
    assert flight.error_m().max() < 0.5
    assert flight.error_m(6.0).max() < 0.05


def test_pressing_on_the_ground_neither_tips_over_nor_winds_up() -> None:
    pressed = flown(CONFIG, at_rest(CONFIG, (0, 0, GEAR_HEIGHT_M)), lambda _: holding((3.0, 0, -2.0)), 20.0)
    assert pressed.tilt_rad.max() < math.radians(1)
    assert np.linalg.norm(pressed.position_m[-1, :2]) < 0.01
    flight = flown(CONFIG, pressed.end, lambda _: holding((0, 0, 3.0)), 6.0)
    assert flight.position_m[:, 2].max() < 3.1
    np.testing.assert_allclose(flight.position_m[-1], [0, 0, 3.0], atol=0.02)


def test_without_solid_surfaces_a_flying_drone_passes_through_a_roof_and_the_ground() -> None:
    config = PlantConfig(airframe=REPORT_AIRFRAME, controller=ControllerKind.LQR, ground_effect=False, solid=False)
    flight = flown(
        config, hovering(config, (0, 0, 3.0)), lambda _: holding((0.0, 0.0, -1.0)), 6.0, deck_at=driving(height_m=1.5)
    )
    assert flight.position_m[-1] == pytest.approx([0.0, 0.0, -1.0], abs=0.01)
    assert set(flight.surface) == {Surface.NONE}


def test_without_solid_surfaces_a_drone_stands_on_the_ground_until_its_motors_run() -> None:
    config = PlantConfig(solid=False)
    flight = flown(config, at_rest(config, (0, 0, GEAR_HEIGHT_M)), lambda _: None, 2.0)
    assert flight.position_m[-1, 2] == pytest.approx(GEAR_HEIGHT_M, abs=0.01)
    assert flight.surface[-1] is Surface.GROUND
