"""What the real detector is told of the simulated camera, as the files that it reads."""

from pathlib import Path

from companion.eyes.calibration import dump_calibration
from link.program.toml_config import dump_toml
from scenarios.config import Scenario
from scenarios.simulation.camera_scene import CameraScene, mounting_told
from scenarios.simulation.noise import Seed

CALIBRATION, MOUNTED, BOARD = "camera.yaml", "mounting.toml", "board.toml"


def write_camera_files(scenario: Scenario, seed: Seed, folder: Path) -> None:
    """Write calibration, mounting and board, with the errors of the seed, into a folder that exists."""
    system = CameraScene(scenario, seed).system
    (folder / CALIBRATION).write_text(dump_calibration(system.camera), encoding="utf-8")
    (folder / MOUNTED).write_text(dump_toml(mounting_told(scenario)), encoding="utf-8")
    (folder / BOARD).write_text(dump_toml(system.board.config), encoding="utf-8")


def detector_arguments(folder: Path) -> list[str]:
    """Return the options of `pad-detector run` by which it reads them."""
    return [
        *("--calibration", str(folder / CALIBRATION)),
        *("--mounting", str(folder / MOUNTED)),
        *("--board", str(folder / BOARD)),
    ]
