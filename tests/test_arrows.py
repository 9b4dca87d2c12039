"""The one direction of imports between the packages and between their folders, and the one home of each library."""

import ast
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAY_IMPORT = {
    "link": {"link"},
    "companion": {"companion", "link"},
    "sim_autopilot": {"sim_autopilot", "link"},
    "scenarios": {"scenarios", "companion", "sim_autopilot", "link"},
}
HOMES = {
    "zenoh": {
        *(f"link/zenoh/{name}.py" for name in ("session", "replies", "library_config")),
        "link/ros2/session.py",
        "link/ros2/ros_node.py",
    },
    "foxglove": {"link/recording/foxglove_server.py", "scenarios/view/foxglove_layout.py"},
    "xxhash": {"link/ros2/attachment.py"},
    "pymavlink": {"link/mavlink/dialect.py"},
    "rosbags": {
        "link/payloads/cdr.py",
        "link/payloads/ros_fields.py",
        "link/payloads/ros_motion.py",
        "link/payloads/decklander_msgs.py",
        "link/payloads/ros_images.py",
        "link/payloads/ros_sensors.py",
        "link/ros2/type_hash.py",
        "link/ros2/gps_fix.py",
        "link/ros2/land_types.py",
    },
    "mcap": {"link/recording/mcap_reader.py", "link/recording/mcap_writer.py"},
    "osqp": {"companion/planning/qp.py"},
    "daqp": {"companion/planning/qp.py"},
    "filterpy": {"companion/vehicle/lkf.py", "companion/vehicle/ukf.py"},
    "polars": {"scenarios/campaigns/landings_file.py"},
    "loky": {"scenarios/processes/local_workers.py"},
    "cma": {"scenarios/falsify/strategy.py"},
    "viser": {f"scenarios/view/{name}.py" for name in ("page", "panel", "plots", "scene")},
    "distributed": {"scenarios/processes/dask_workers.py"},
    "fpdf": {"companion/eyes/pdf.py"},
    "ruamel": {"companion/eyes/calibration.py"},
}


def sources(package: str) -> list[Path]:
    """The Python files of a package."""
    return sorted((ROOT / package).rglob("*.py"))


@cache
def imported(path: Path) -> frozenset[str]:
    """The top-level names that a file imports, wherever in it; a module named at run time is not seen."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            names.add(node.module.split(".")[0])
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith("import_module"):
            names |= {str(one.value).split(".")[0] for one in node.args if isinstance(one, ast.Constant)}
    return frozenset(names)


@pytest.mark.slow
@pytest.mark.parametrize("package", sorted(MAY_IMPORT))
def test_package_imports_only_what_its_arrows_allow(package: str) -> None:
    forbidden = set(MAY_IMPORT) - MAY_IMPORT[package] | {"tests"}
    wrong = {str(path.relative_to(ROOT)): found for path in sources(package) if (found := imported(path) & forbidden)}
    assert wrong == {}


@pytest.mark.slow
@pytest.mark.parametrize("library", sorted(HOMES))
def test_library_has_one_home(library: str) -> None:
    users = {
        str(path.relative_to(ROOT)) for package in MAY_IMPORT for path in sources(package) if library in imported(path)
    }
    assert users == HOMES[library]


@pytest.mark.slow
def test_the_eyes_share_nothing_with_the_rest_of_the_companion_but_link() -> None:
    # a program of its own, which may run on another computer of the drone
    for path in sources("companion"):
        names = {
            node.module
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.ImportFrom) and node.module is not None and node.module.startswith("companion.")
        }
        is_eyes = path.is_relative_to(ROOT / "companion" / "eyes")
        of_eyes = {name for name in names if name.split(".")[1] == "eyes"}
        assert (names - of_eyes if is_eyes else of_eyes) == set(), path


def folder_arrows(package: str) -> dict[str, set[str]]:
    """For each folder of a package those that its files import from; modules beside the folders do not count."""
    root = ROOT / package.replace(".", "/")
    folders = {path.parent.name for path in root.glob("*/__init__.py")}
    arrows: dict[str, set[str]] = {folder: set() for folder in folders}
    for folder in folders:
        for path in (root / folder).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(f"{package}."):
                    arrows[folder].add(str(node.module).removeprefix(f"{package}.").split(".")[0])
        arrows[folder] = arrows[folder] & folders - {folder}
    return arrows


@pytest.mark.slow
@pytest.mark.parametrize("package", sorted({*MAY_IMPORT, "companion.landing"}))
def test_folders_of_a_package_import_each_other_in_one_direction(package: str) -> None:
    order = list(TopologicalSorter(folder_arrows(package)).static_order())
    assert order
