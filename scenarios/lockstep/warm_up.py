"""Compiles the numerical kernels once after an installation: `python -m scenarios.lockstep.warm_up`.

They are kept for the user who runs it: in the folder NUMBA_CACHE_DIR, else beside the sources, else in the user's
cache. What was compiled for other sources goes.
"""

import sys
from functools import cache

from link.errors import UserError
from link.program.cli import EXIT_OK, EXIT_USER_ERROR


@cache
def warm_process() -> None:
    """Make a step of the whole stack in this process, which loads what is loaded once, as the programs do at start.

    Raises:
        UserError: there is no place to keep what is compiled.
    """
    # Loaded here, so that what is wrong with the place for machine code is told as one line.
    from link.program.clock import collect_rarely, spare_present_objects  # noqa: PLC0415 (see above)

    collect_rarely()
    from scenarios.catalogue.catalogue import load_scenario  # noqa: PLC0415 (see above)
    from scenarios.lockstep.lockstep import Lockstep  # noqa: PLC0415 (see above)

    Lockstep(load_scenario("straight_5"), seed=1).step()
    spare_present_objects()


def main() -> int:
    """Compile what a step needs into the cache and return the exit code."""
    sys.stderr.write("compiling the numerical kernels, once; this takes a minute or two\n")
    try:
        warm_process()
    except UserError as error:
        sys.stderr.write(f"scenarios.lockstep.warm_up: {error}\n")
        return EXIT_USER_ERROR
    from link.compiled import remove_outdated  # noqa: PLC0415 (it loads numba)

    remove_outdated()
    return EXIT_OK


if __name__ == "__main__":
    sys.exit(main())
