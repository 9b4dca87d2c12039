"""No step of a flight waits for a compiler."""

import sys
from collections.abc import Iterator

import pytest
from numba.core.dispatcher import Dispatcher

from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep


def kernels_of_the_companion() -> Iterator[Dispatcher]:
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] == "companion":
            yield from (value for value in vars(module).values() if isinstance(value, Dispatcher))


@pytest.mark.slow
def test_what_the_companion_compiles_is_compiled_before_its_first_step() -> None:
    scenario = load_scenario("rough_road_5+sensors=nominal").with_run(time_limit_s=16.0)
    lockstep = Lockstep(scenario, seed=1)
    before = {id(kernel): len(kernel.signatures) for kernel in kernels_of_the_companion()}
    lockstep.run()
    assert sum(before.values()) > 5
    assert {id(kernel): len(kernel.signatures) for kernel in kernels_of_the_companion()} == before
