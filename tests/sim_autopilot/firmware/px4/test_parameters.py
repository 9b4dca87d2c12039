"""PX4's position control: the gains are those of its parameters, and what flies obeys them."""

import pytest

from link.records import replace
from sim_autopilot.control.parameters import ControllerKind
from sim_autopilot.core.data import Reference
from sim_autopilot.core.parameters import default_values
from sim_autopilot.firmware.px4.parameters import flight_settings
from sim_autopilot.firmware.px4.px4 import PX4
from sim_autopilot.physics.airframe import PX4_AIRFRAME
from sim_autopilot.plant.config import PlantConfig
from tests.sim_autopilot.flights import flown, going, hovering

_SPEED_M_S = 5.0


def plant(**changed: float) -> PlantConfig:
    """PX4's own simulated drone under its position control, with some parameters changed."""
    settings = flight_settings(default_values(PX4.parameters.table, changed))
    return PlantConfig(airframe=PX4_AIRFRAME, envelope=settings.envelope, gains=settings.gains)


def behind_m(config: PlantConfig, for_s: float) -> float:
    """How far a drone that began at the speed of its setpoints is behind them after a time."""
    memory = hovering(config, (0.0, 0.0, 20.0), 0.0, velocity=(_SPEED_M_S, 0.0, 0.0))
    flight = flown(config, memory, _wanted, for_s)
    return _SPEED_M_S * for_s - float(flight.position_m[-1, 0])


def _wanted(t_s: float) -> Reference:
    return going((_SPEED_M_S * t_s, 0.0, 20.0), (_SPEED_M_S, 0.0, 0.0), (0.0, 0.0, 0.0))


def test_gains_are_the_defaults_that_px4_states() -> None:
    gains = plant().gains
    assert gains is not None
    assert (gains.level.position_per_s, gains.level.velocity_per_s, gains.level.integral_per_s2) == (0.95, 1.8, 0.4)
    assert (gains.level.derivative, gains.attitude_per_s) == (0.2, 4.0)  # the derivative's and MC_ROLL_P


def test_drag_holds_the_drone_back_until_the_integral_has_grown() -> None:
    at_once_m = 0.3 * _SPEED_M_S / (1.8 * 0.95)  # drag over the stiffness, were there no integral
    assert 0.5 * at_once_m < behind_m(plant(), 2.0) < at_once_m
    assert behind_m(plant(), 20.0) < 0.1 * at_once_m


def test_a_stiffer_position_gain_is_less_behind() -> None:
    assert behind_m(plant(MPC_XY_P=1.9), 2.0) < 0.8 * behind_m(plant(), 2.0)


def test_without_an_integral_the_drone_stays_behind_by_drag_over_stiffness() -> None:
    assert behind_m(plant(MPC_XY_VEL_I_ACC=0.0), 15.0) == pytest.approx(0.3 * _SPEED_M_S / (1.8 * 0.95), rel=0.05)


def test_linear_quadratic_control_flies_the_gains_that_the_firmware_states() -> None:
    lqr = replace(plant(), controller=ControllerKind.LQR_FEEDFORWARD)
    assert behind_m(lqr, 2.0) == pytest.approx(behind_m(plant(), 2.0), rel=0.1)
