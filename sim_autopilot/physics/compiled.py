"""How a numeric function becomes machine code: deterministic, no fast-math, kept on disk between runs."""

from collections.abc import Callable
from typing import ParamSpec, Protocol, TypeVar, cast

from numba import njit

P = ParamSpec("P")
R_co = TypeVar("R_co", covariant=True)


class Kernel(Protocol[P, R_co]):
    """A compiled function beside the Python that it came from."""

    py_func: Callable[P, R_co]

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R_co:
        """Run the machine code."""


def kernel(function: Callable[P, R_co]) -> Kernel[P, R_co]:
    """Compile `function` at its first call."""
    return cast("Kernel[P, R_co]", njit(cache=True, fastmath=False, error_model="numpy")(function))
