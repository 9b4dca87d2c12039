"""How a numeric function becomes machine code: deterministic, no fast-math, kept on disk between runs."""

import hashlib
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, ParamSpec, Protocol, TypeVar, cast

import numba
from numba import njit
from numba.core import event

from link.errors import UserError
from link.program.interrupts import begin_compiling, end_compiling

_TRIED_NUMBA = (0, 68)
if numba.version_info.short == _TRIED_NUMBA:  # others load what they keep in their own way: more memory, the same code
    from link.kept_code import load_without_intermediate_code

    load_without_intermediate_code()

_KEPT_NAME = re.compile(r"_(?P<digest>[0-9a-f]{12})-[0-9]+\.")
"""The end of a function's name and its line, in the name of a file that numba keeps."""


class _Compiler(event.Listener):  # type: ignore[misc]  # numba has few annotations
    """Told by numba of all that it compiles; what it only loads is none of that."""

    def on_start(self, event: object) -> None:  # noqa: ARG002 (numba's)
        begin_compiling()

    def on_end(self, event: object) -> None:  # noqa: ARG002 (numba's)
        end_compiling()


event.register("numba:compile", _Compiler())

_OPTIONS: Any = {"fastmath": False, "error_model": "numpy", "no_cfunc_wrapper": True}
"""No entry from C: no kernel is handed on as a value, and such entries are a twentieth of what compiling costs."""

P = ParamSpec("P")
R = TypeVar("R")


class Kept(Protocol):
    """Where numba keeps machine code."""

    @property
    def cache_path(self) -> str:
        """Of the folder."""


class Kernel(Protocol[P, R]):
    """A compiled function beside the Python that it came from."""

    py_func: Callable[P, R]
    signatures: list[object]

    @property
    def stats(self) -> "Kept":
        """What numba tells about it."""

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """Run the machine code."""


def kernel(function: Callable[P, R]) -> Kernel[P, R]:
    """Compile `function` into whatever compiled function calls it.

    Not kept on disk by itself: numba would go on using it after a change in another file that it calls.
    """
    return cast("Kernel[P, R]", njit(**_OPTIONS)(function))


def kept_kernel(sources: int) -> Callable[[Callable[P, R]], Kernel[P, R]]:
    """Compile a function at its first call, with all that it calls, and keep that on disk.

    Args:
        sources: the digest of all that it calls. It becomes part of the name by which the machine code is
            kept, since numba's own key knows only the file of the function itself.

    Raises:
        UserError: from what is returned: there is no place to keep it, so each start would compile for a minute.
    """

    def kept(function: Callable[P, R]) -> Kernel[P, R]:
        digest = f"{sources ^ _FLAGS:012x}"
        function.__qualname__ += f"_{digest}"
        try:
            compiled = cast("Kernel[P, R]", njit(cache=True, **_OPTIONS)(function))
        except RuntimeError as error:  # numba's, after it has tried every place that it knows
            raise UserError(
                f"machine code cannot be kept: neither {Path(function.__code__.co_filename).parent} nor a cache of "
                "this user's can be written; set NUMBA_CACHE_DIR to a folder that can"
            ) from error
        _kept_kernels.append((compiled, digest))
        return compiled

    return kept


def remove_outdated() -> int:
    """Remove what is kept on disk for other sources than those that are loaded; return how many files that were.

    Beside the functions that are loaded only: of what is not, nothing is known. Another process that finds a file gone
    compiles it anew.
    """
    digests: dict[str, set[str]] = {}
    for function, digest in _kept_kernels:
        digests.setdefault(function.stats.cache_path, set()).add(digest)
    outdated = [
        path
        for folder, current in digests.items()
        for path in Path(folder).glob("*.nb[ci]")
        if (match := _KEPT_NAME.search(path.name)) is not None and match["digest"] not in current
    ]
    for path in outdated:
        path.unlink(missing_ok=True)
    return len(outdated)


def count_compiled() -> tuple[int, int]:
    """Return how many of the kept functions that are loaded have their machine code, and how many they are."""
    return sum(bool(function.signatures) for function, _ in _kept_kernels), len(_kept_kernels)


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

_kept_kernels: list[tuple[Any, str]] = []
