"""Compiles the numerical kernels once after an installation: `python -m scenarios.warm_up`.

What was compiled for other sources goes.
"""

import sys
from functools import cache

from link.compiled import remove_outdated
from link.real_time import spare_present_objects
from scenarios.catalogue import load_scenario
from scenarios.lockstep import Lockstep


@cache
def warm_process() -> None:
    """Make a step of the whole stack in this process, which loads what is loaded once, as the programs do at start."""
    Lockstep(load_scenario("straight_5"), seed=1).step()
    spare_present_objects()


def main() -> None:
    """Compile what a step needs into the cache beside the sources."""
    sys.stderr.write("compiling the numerical kernels, once\n")
    warm_process()
    remove_outdated()


if __name__ == "__main__":
    main()
