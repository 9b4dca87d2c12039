"""What a program does before it keeps time with a clock."""

import gc


def spare_present_objects() -> None:
    """Take all objects that there are now out of every later collection of garbage.

    A full collection looks at everything that is alive: with numba's compiler loaded that is 140 to 200 ms, ten control
    periods, at an instant that nobody chooses. What starting a program made is hardly ever garbage; what is made from
    now on is still looked after. Source: `gc.freeze` in the Python library reference.
    """
    gc.collect()
    gc.freeze()
