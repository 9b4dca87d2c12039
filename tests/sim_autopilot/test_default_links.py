import gc
from types import BuiltinFunctionType, FunctionType, ModuleType

import pytest

from link.transports.device import parse_device
from sim_autopilot.runtime.build import autopilot_config, with_default_links
from sim_autopilot.runtime.config import LinkConfig, SimAutopilotConfig
from tests.sim_autopilot.clients import Clients
from tests.sim_autopilot.pilot import px4


def devices(firmware: str, instance: int) -> list[str]:
    config = SimAutopilotConfig.model_validate({"firmware": firmware, "instance": instance})
    return [str(parse_device(link.device)) for link in with_default_links(config).links]


@pytest.mark.parametrize(
    ("firmware", "instance", "expected"),
    [
        ("px4", 0, ["udpout:127.0.0.1:14540:14580", "udpout:127.0.0.1:14550:18570"]),
        ("px4", 3, ["udpout:127.0.0.1:14543:14583", "udpout:127.0.0.1:14550:18573"]),
        ("px4", 12, ["udpout:127.0.0.1:14549:14592", "udpout:127.0.0.1:14550:18582"]),
        ("ardupilot", 0, ["tcpin:127.0.0.1:5760", "udpout:127.0.0.1:14550"]),
        ("ardupilot", 2, ["tcpin:127.0.0.1:5780", "udpout:127.0.0.1:14570"]),
    ],
)
def test_the_links_are_those_of_the_firmwares_own_simulator(firmware: str, instance: int, expected: list[str]) -> None:
    assert devices(firmware, instance) == expected


def test_links_that_are_named_take_the_place_of_the_default_ones() -> None:
    config = SimAutopilotConfig(links=(LinkConfig(device="udpin:127.0.0.1:9"),))
    assert with_default_links(config) == config


def test_the_system_id_is_shifted_by_the_instance() -> None:
    assert autopilot_config(SimAutopilotConfig(instance=6)).system_id == 7


def held_by(root: object) -> int:
    """How many objects hang on `root`: of the whole process as many may go as other tests have left behind."""
    found, left = {id(root)}, [root]
    while left:
        for one in gc.get_referents(left.pop()):
            if id(one) not in found and not isinstance(one, type | ModuleType | FunctionType | BuiltinFunctionType):
                found.add(id(one))
                left.append(one)
    return len(found)


@pytest.mark.slow
def test_an_idle_autopilot_neither_grows_nor_drifts() -> None:
    clients, counts, objects = Clients(px4()), [], []
    clients.run(10.0)
    for _ in range(3):
        clients.forget()
        clients.run(4.0)
        counts.append([clients.counts(link) for link in (0, 1)])
        clients.forget()
        objects.append(held_by(clients))
    assert counts[0] == counts[1] == counts[2]
    assert max(objects) - min(objects) < 10
