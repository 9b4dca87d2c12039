"""MAVSDK takes the stand-in for the autopilot that it stands in for."""

from collections.abc import Iterator

import pytest

from tests.conformance.mavsdk_client import CASES
from tests.conformance.programs import StandIn, outcomes, stand_in

pytestmark = [pytest.mark.wire, pytest.mark.timeout(600)]


@pytest.fixture(scope="module", params=["px4", "ardupilot"])
def autopilot(request: pytest.FixtureRequest) -> Iterator[StandIn]:
    """A stand-in for all cases of the module: none starts it anew."""
    with stand_in(request.param) as here:
        yield here


@pytest.fixture(scope="module")
def over_udp(autopilot: StandIn) -> dict[str, str]:
    """What every case came to over UDP."""
    return outcomes("mavsdk_client", f"udpin://127.0.0.1:{autopilot.udp_port}", autopilot.firmware)


@pytest.mark.parametrize("case", [case.__name__ for case in CASES])
def test_mavsdk_finds_that_it(case: str, over_udp: dict[str, str]) -> None:
    assert over_udp.get(case) == "ok"


def test_mavsdk_flies_over_tcp_what_it_flies_over_udp(autopilot: StandIn, over_udp: dict[str, str]) -> None:
    names = ("is_healthy", "sets_parameters", "keeps_a_fence", "takes_off_and_lands")
    url = f"tcpout://127.0.0.1:{autopilot.tcp_port}"
    assert outcomes("mavsdk_client", url, autopilot.firmware, *names) == {name: over_udp[name] for name in names}
