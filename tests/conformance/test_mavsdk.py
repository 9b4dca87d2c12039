"""MAVSDK takes the stand-in for the autopilot that it stands in for."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import pytest

from tests.conformance.mavsdk_client import CASES
from tests.conformance.programs import outcomes, stand_in

pytestmark = [pytest.mark.wire, pytest.mark.timeout(600)]


FIRMWARES = ("px4", "ardupilot")
OVER_TCP = ("is_healthy", "sets_parameters", "keeps_a_fence", "takes_off_and_lands")


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """What every case came to over UDP, and some of them over TCP after that."""

    over_udp: dict[str, str]
    over_tcp: dict[str, str]


def clients_of(firmware: str) -> Found:
    """Run all clients against one stand-in, which none starts anew."""
    with stand_in(firmware) as here:
        return Found(
            over_udp=outcomes("mavsdk_client", f"udpin://127.0.0.1:{here.udp_port}", firmware),
            over_tcp=outcomes("mavsdk_client", f"tcpout://127.0.0.1:{here.tcp_port}", firmware, *OVER_TCP),
        )


@pytest.fixture(scope="module")
def found() -> dict[str, Found]:
    """By firmware; both at once, for the clients mostly wait."""
    with ThreadPoolExecutor() as both:
        return dict(zip(FIRMWARES, both.map(clients_of, FIRMWARES), strict=True))


@pytest.mark.parametrize("firmware", FIRMWARES)
@pytest.mark.parametrize("case", [case.__name__ for case in CASES])
def test_mavsdk_finds_that_it(case: str, firmware: str, found: dict[str, Found]) -> None:
    assert found[firmware].over_udp.get(case) == "ok"


@pytest.mark.parametrize("firmware", FIRMWARES)
def test_mavsdk_flies_over_tcp_what_it_flies_over_udp(firmware: str, found: dict[str, Found]) -> None:
    assert found[firmware].over_tcp == {name: found[firmware].over_udp[name] for name in OVER_TCP}
