"""How a numeric function becomes machine code: deterministic, no fast-math, kept on disk between runs."""

import hashlib
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import ParamSpec, Protocol, TypeVar, cast

from numba import njit

P = ParamSpec("P")
R = TypeVar("R")


class Kernel(Protocol[P, R]):
    """A compiled function beside the Python that it came from."""

    py_func: Callable[P, R]
    signatures: list[object]

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """Run the machine code."""


def kernel(function: Callable[P, R]) -> Kernel[P, R]:
    """Compile `function` into whatever compiled function calls it.

    Not kept on disk by itself: numba would go on using it after a change in another file that it calls.
    """
    return cast("Kernel[P, R]", njit(fastmath=False, error_model="numpy")(function))


def kept_kernel(sources: int) -> Callable[[Callable[P, R]], Kernel[P, R]]:
    """Compile a function at its first call, with all that it calls, and keep that on disk.

    Args:
        sources: the digest of all that it calls. It becomes part of the name by which the machine code is
            kept, since numba's own key knows only the file of the function itself.
    """

    def kept(function: Callable[P, R]) -> Kernel[P, R]:
        function.__qualname__ += f"_{sources ^ _FLAGS:012x}"
        return cast("Kernel[P, R]", njit(cache=True, fastmath=False, error_model="numpy")(function))

    return kept


def source_digest(folders: Iterable[Path]) -> int:
    """Return a number that changes with any source in `folders`, or with any of their names."""
    return file_digest(path for folder in folders for path in folder.glob("*.py"))


def file_digest(files: Iterable[Path]) -> int:
    """Return a number that changes with any of the files, or with any of their names."""
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(path.name.encode() + path.read_bytes())
    return int.from_bytes(digest.digest()[:6], "big")


_FLAGS = file_digest([Path(__file__)])
"""Stands for the flags above, which numba's key does not know."""
