"""Compiled functions that are kept on disk."""

import subprocess
import sys
from pathlib import Path

import pytest

from link.compiled import source_digest

INNER = """
from link.compiled import kernel


@kernel
def inner(x: float) -> float:
    return {factor} * x
"""

OUTER = """
import sys
from pathlib import Path

from inner import inner
from link.compiled import kept_kernel, remove_outdated, source_digest


@kept_kernel(source_digest([Path(__file__).parent]))
def outer(x: float) -> float:
    return inner(x) + 1.0


print(outer(10.0), len(outer.stats.cache_hits))
if "tidy" in sys.argv:
    print(remove_outdated())
"""


def said(folder: Path, factor: float, *words: str, program: str = "outer.py") -> list[float]:
    """What a program says whose inner function multiplies by `factor`, and how often it found its code on disk."""
    (folder / "inner.py").write_text(INNER.format(factor=factor))
    (folder / "outer.py").write_text(OUTER)
    root = str(Path(__file__).parents[2])
    path = {"PYTHONPATH": root, "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, program, *words],
        cwd=folder,
        env=path,
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    return [float(word) for word in done.stdout.split()]


@pytest.mark.slow
def test_kept_code_is_used_again_never_after_a_change_in_a_file_that_it_calls_and_then_removed(tmp_path: Path) -> None:
    assert said(tmp_path, 2.0) == [21.0, 0.0]
    assert said(tmp_path, 2.0) == [21.0, 1.0]
    kept = tmp_path / "__pycache__"
    old = set(kept.iterdir())
    other = kept / "another.one-7.py311.1.nbc"
    other.touch()
    assert said(tmp_path, 3.0, "tidy") == [31.0, 0.0, len(old)]
    assert other.exists()
    assert not old & set(kept.iterdir())
    assert said(tmp_path, 3.0, "tidy") == [31.0, 1.0, 0.0]


@pytest.mark.slow
def test_without_a_place_to_keep_code_one_line_says_what_to_set(tmp_path: Path) -> None:
    """As for a service's user, who has no home and may not write into the installation."""
    (tmp_path / "inner.py").write_text(INNER.format(factor=2.0))
    (tmp_path / "outer.py").write_text(OUTER)
    for place in ("__pycache__", "cache"):  # a file where numba wants a folder is refused to every user, root too
        (tmp_path / place).touch()
    said_last = {}
    for name, more in {"nowhere": {}, "there": {"NUMBA_CACHE_DIR": str(tmp_path / "numba")}}.items():
        environment = {
            "PYTHONPATH": str(Path(__file__).parents[2]),
            "PYTHONDONTWRITEBYTECODE": "1",
            "XDG_CACHE_HOME": str(tmp_path / "cache"),
        }
        command = [sys.executable, "-c", "from outer import outer"]
        done = subprocess.run(
            command, cwd=tmp_path, env=environment | more, capture_output=True, text=True, check=False, timeout=120
        )
        said_last[name] = (done.stderr or done.stdout).splitlines()[-1]
    assert said_last["nowhere"].startswith("link.errors.UserError: machine code cannot be kept:")
    assert str(tmp_path) in said_last["nowhere"]
    assert "NUMBA_CACHE_DIR" in said_last["nowhere"]
    assert said_last["there"] == "21.0 0"


def test_the_digest_knows_names_and_contents(tmp_path: Path) -> None:
    first, second = tmp_path / "a.py", tmp_path / "b.py"
    first.write_text("x = 1")
    digests = [source_digest([tmp_path])]
    first.write_text("x = 2")
    digests.append(source_digest([tmp_path]))
    first.rename(second)
    digests.append(source_digest([tmp_path]))
    assert len(set(digests)) == 3


CALLER = """
from outer import outer
from link.compiled import kernel


@kernel
def caller(x: float) -> float:
    return outer(x) - 1.0


def is_parsed() -> bool:
    return next(iter(outer.overloads.values())).library._shared_module is not None


print(int(is_parsed()), caller(10.0), int(is_parsed()), len(outer.stats.cache_hits))
"""


@pytest.mark.slow
def test_intermediate_code_is_parsed_only_where_a_function_is_compiled_that_calls_it(tmp_path: Path) -> None:
    (tmp_path / "caller.py").write_text(CALLER)
    assert said(tmp_path, 2.0, program="caller.py")[-4:] == [1.0, 20.0, 1.0, 0.0]
    assert said(tmp_path, 2.0, program="caller.py")[-4:] == [0.0, 20.0, 1.0, 1.0]


@pytest.mark.slow
def test_another_numba_loads_kept_code_in_its_own_way(tmp_path: Path) -> None:
    """With one that was not tried, and has none of the private names."""
    (tmp_path / "another.py").write_text(
        "import sys\n"
        "import numba\n"
        "numba.version_info = numba.version_info._replace(short=(0, 99))\n"
        "sys.modules['link.kept_code'] = None\n"
        "import outer\n"
    )
    assert said(tmp_path, 2.0) == [21.0, 0.0]
    assert said(tmp_path, 2.0, program="another.py") == [21.0, 1.0]
