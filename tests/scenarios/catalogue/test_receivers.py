"""What the companion of a scenario can know of its receivers: by what they state, or by who flies it."""

from pathlib import Path

import pytest

from companion.config.integrity import ReceiverFrames
from scenarios.catalogue.catalogue import load_scenario
from scenarios.simulation.drone import sim_autopilot_config

ONE, AUTO, APART = ReceiverFrames.ONE, ReceiverFrames.AUTO, ReceiverFrames.APART


@pytest.mark.parametrize(("sensors", "frames"), [("rtk", ONE), ("report", ONE), ("nominal", AUTO), ("degraded", AUTO)])
def test_companion_is_told_of_receivers_in_one_frame_only(sensors: str, frames: ReceiverFrames) -> None:
    assert load_scenario(f"straight_5+sensors={sensors}").system.companion.integrity.receiver_frames is frames


def test_what_a_file_says_of_its_receivers_stays(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text('base = "straight_5"\n[system.companion.integrity]\nreceiver_frames = "apart"\n', encoding="utf-8")
    assert load_scenario(str(path)).system.companion.integrity.receiver_frames is APART


@pytest.mark.parametrize(("sensors", "accuracy_m"), [("rtk", 0.01), ("nominal", 0.02), ("degraded", 1.2)])
def test_drones_receiver_states_how_well_the_drone_knows_its_place(sensors: str, accuracy_m: float) -> None:
    config = sim_autopilot_config(load_scenario(f"straight_5+sensors={sensors}"), 1, instant=True)
    assert config.own_state.receiver_accuracy_m == accuracy_m
