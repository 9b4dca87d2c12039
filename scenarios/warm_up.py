"""Compiles the numerical kernels once after an installation: `python -m scenarios.warm_up`."""

import sys

from scenarios.catalogue import load_scenario
from scenarios.lockstep import Lockstep


def main() -> None:
    """Make one step of the whole stack, which compiles what it needs into the cache beside the sources."""
    sys.stderr.write("compiling the numerical kernels, once\n")
    Lockstep(load_scenario("straight_5"), seed=1).step()


if __name__ == "__main__":
    main()
