from math import pi, radians
from pathlib import Path

import numpy as np
import pytest

from link.errors import UserError
from link.program.toml_config import dump_toml, load_config
from sim_autopilot.control.parameters import ControllerKind
from sim_autopilot.physics.airframe import BENCHMARK_AIRFRAME
from sim_autopilot.plant.own_state import OwnStateError
from sim_autopilot.runtime.build import autopilot_config
from sim_autopilot.runtime.config import DroneConfig, SimAutopilotConfig, WindConfig
from sim_autopilot.runtime.physics import airframe_of, wind_model


def loaded(tmp_path: Path, text: str) -> SimAutopilotConfig:
    path = tmp_path / "sim.toml"
    path.write_text(text, encoding="utf-8")
    return load_config(path, SimAutopilotConfig)


def test_a_printed_configuration_reads_back_the_same(tmp_path: Path) -> None:
    text = "instance = 3\n[wind]\nmean_m_s = 5.0\nturbulence = 'light'\n[parameters]\nMPC_XY_VEL_MAX = 20.0\n"
    config = loaded(tmp_path, text)
    assert loaded(tmp_path, dump_toml(config)) == config


def test_a_configuration_reaches_the_autopilot(tmp_path: Path) -> None:
    config = autopilot_config(
        loaded(
            tmp_path,
            "instance = 3\n[datum]\nlatitude_deg = 47.0\n[drone]\ncontroller = 'lqr'\n[start]\n"
            "position_enu_m = [1.0, 2.0, 1.5]\nyaw_rad = 0.3\n[parameters]\nMPC_XY_VEL_MAX = 20.0\n",
        )
    )
    assert config.system_id == 4
    assert config.datum.latitude_rad == radians(47.0)
    assert config.plant.controller is ControllerKind.LQR
    assert config.position_enu_m == pytest.approx((1.0, 2.0, 1.62))
    assert config.parameters == {"MPC_XY_VEL_MAX": 20.0}


def test_an_unknown_firmware_parameter_is_one_clear_line(tmp_path: Path) -> None:
    config = loaded(tmp_path, "[parameters]\nMPC_XY_VEL = 20.0\n")
    with pytest.raises(UserError, match="parameters: no parameter MPC_XY_VEL; there is MPC_XY_VEL_MAX"):
        autopilot_config(config)


def test_an_unknown_key_is_named_with_the_file(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"sim\.toml: unknown key 'instanse', did you mean 'instance'\?"):
        loaded(tmp_path, "instanse = 1\n")


@pytest.mark.parametrize(
    "text",
    [
        "[range_finder]\nmax_m = 1000.0",
        "[start]\nposition_enu_m = [1e300, 0.0, 0.0]",
        "[start]\nposition_enu_m = [0.0, 0.0, -10000.0]",
        "[start]\nvelocity_enu_m_s = [1e9, 0.0, 0.0]",
        "[own_state]\norigin_step_enu_m = [1e300, 0.0, 0.0]",
    ],
)
def test_what_no_message_could_tell_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(UserError, match=r"sim\.toml: .+ does not fit"):
        loaded(tmp_path, text)


def test_a_range_that_ends_before_it_begins_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"sim\.toml: .+ min_m must be less than max_m, 1"):
        loaded(tmp_path, "[range_finder]\nmin_m = 2.0\nmax_m = 1.0")


def test_the_wind_blows_away_from_where_it_comes_from(tmp_path: Path) -> None:
    config = loaded(tmp_path, f"[wind]\nmean_m_s = 5.0\nfrom_rad = {pi / 3.0}\n")
    wind = wind_model(config).advance(0.01, 0.0)
    assert np.allclose(wind, (-2.5, -5.0 * np.sin(pi / 3.0), 0.0))


def test_the_seed_draws_the_winds_direction() -> None:
    def wind(seed: int) -> tuple[float, ...]:
        config = SimAutopilotConfig.model_validate({"seed": seed, "wind": {"mean_m_s": 5.0}})
        return tuple(wind_model(config).advance(0.01, 0.0))

    assert wind(1) == wind(1)
    assert wind(1) != wind(2)


@pytest.mark.parametrize(("position_std_m", "stated_m"), [(0.0, 0.01), (0.5, 0.5)])
def test_the_receiver_states_what_the_drone_knows_unless_it_is_told(position_std_m: float, stated_m: float) -> None:
    own_state = {"position_std_m": position_std_m}
    assert stated(own_state) == stated_m
    assert stated(own_state | {"receiver_accuracy_m": 2.0}) == 2.0


def stated(own_state: dict[str, float]) -> float | None:
    config = SimAutopilotConfig.model_validate({"own_state": own_state})
    return autopilot_config(config).own_state.receiver_accuracy_m


def test_wind_turbulence_and_own_errors_of_a_seed_are_independent() -> None:
    seeds = 400
    draws = np.empty((3, seeds))
    for seed in range(seeds):
        config = SimAutopilotConfig.model_validate(
            {"seed": seed, "wind": {"turbulence": "light"}, "own_state": {"position_std_m": 0.5}}
        )
        turned, still = (wind_model(config.model_copy(update={"wind": wind})) for wind in _winds(config))
        own_state = OwnStateError(autopilot_config(config).own_state, 0.01)
        draws[:, seed] = turned.advance(0.01, 0.0)[0], still.advance(0.01, 0.0)[0], own_state.advance()[0]
    correlation = np.asarray(np.corrcoef(draws))[np.triu_indices(3, k=1)]
    assert np.abs(correlation).max() < 4.0 / np.sqrt(seeds)


def _winds(config: SimAutopilotConfig) -> tuple[WindConfig, WindConfig]:
    """Return a mean wind of a drawn direction without turbulence, and turbulence without a mean wind."""
    mean = config.wind.model_copy(update={"mean_m_s": 5.0, "turbulence": "none"})
    return mean, config.wind.model_copy(update={"from_rad": 0.0})


def test_the_turbulence_may_be_told_by_its_vertical_deviation(tmp_path: Path) -> None:
    light = loaded(tmp_path, "[wind]\nfrom_rad = 0.3\nturbulence = 'light'\n")
    told = loaded(tmp_path, f"[wind]\nfrom_rad = 0.3\nturbulence_std_m_s = {0.1 * 15 * 1852.0 / 3600.0}\n")
    np.testing.assert_allclose(wind_model(told).advance(0.01, 5.0), wind_model(light).advance(0.01, 5.0))


def test_a_drones_own_numbers_take_the_place_of_its_airframes() -> None:
    drone = DroneConfig(mass_kg=2.2, thrust_to_weight=2.4, drag_n_s_m=0.31, motor_time_constant_s=0.03)
    airframe = airframe_of(drone)
    assert (airframe.mass_kg, airframe.thrust_to_weight) == (2.2, 2.4)
    assert (airframe.drag_n_s_m, airframe.motor_time_constant_s) == (0.31, 0.03)
    share = np.array(airframe.inertia_kg_m2) / np.array(BENCHMARK_AIRFRAME.inertia_kg_m2)
    np.testing.assert_allclose(share, 2.2 / BENCHMARK_AIRFRAME.mass_kg)


def test_a_drone_without_numbers_of_its_own_is_its_airframe() -> None:
    assert airframe_of(DroneConfig()) == BENCHMARK_AIRFRAME
