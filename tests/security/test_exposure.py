"""Who can reach a Zenoh session: from this machine anybody, from beyond it nobody without a certificate."""

from pathlib import Path

import psutil  # type: ignore[import-untyped]  # it has no annotations
import pytest

from companion.check.assessment import assess_links
from companion.check.findings import Level
from companion.runtime.options import open_links
from link.errors import UserError
from link.zenoh.exposure import exposed
from link.zenoh.session import ZenohOptions, open_session
from tests.security.secured import SHIPPED, secured

INSECURE = ("tcp/0.0.0.0:7447", "tcp/[::]:7447", "tcp/192.0.2.5:7447", "udp/car.local:1", "ws/10.0.0.1:80")
LOCAL = ("tcp/127.0.0.1:7447", "tcp/[::1]:0", "tcp/localhost:1", "udp/127.8.0.1:5", "unixsock-stream//run/zenoh")


def listening() -> set[tuple[str, int]]:
    """Return the addresses on which this process waits for connections."""
    return {tuple(one.laddr) for one in psutil.Process().net_connections(kind="tcp") if one.status == "LISTEN"}


def test_endpoints_beyond_this_machine_are_exposed_unless_they_are_encrypted_with_certificates_of_both_ends() -> None:
    assert exposed((*INSECURE, *LOCAL, "tls/0.0.0.0:7447")) == list(INSECURE)
    assert exposed(("tls/0.0.0.0:7447", "quic/[::]:1", "tls/127.0.0.1:1"), is_mutual=False) == [
        "tls/0.0.0.0:7447",
        "quic/[::]:1",
    ]


@pytest.mark.parametrize("endpoint", INSECURE)
def test_endpoint_that_strangers_reach_is_refused(endpoint: str) -> None:
    for options in (ZenohOptions(listen=(endpoint,)), ZenohOptions(connect=(endpoint,))):
        with pytest.raises(UserError, match="--insecure"):
            open_session(options)


def test_endpoint_that_strangers_reach_is_opened_where_it_is_wanted() -> None:
    before = listening()
    with open_session(ZenohOptions(listen=("tcp/0.0.0.0:0",), insecure=True)):
        assert len(listening() - before) == 1


@pytest.mark.parametrize(
    "text",
    [
        "{listen: {endpoints: ['tcp/0.0.0.0:0']}}",
        "{listen: {endpoints: {peer: ['tcp/0.0.0.0:0']}}}",
        "{connect: {endpoints: ['tcp/192.0.2.5:7447']}}",
        "{scouting: {multicast: {enabled: true}}}",
        "{listen: {endpoints: ['tls/0.0.0.0:0']}}",
    ],
)
def test_file_that_opens_a_session_to_strangers_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "zenoh.json5"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match="--insecure"):
        open_session(ZenohOptions(config_file=path))


def test_file_without_an_address_to_listen_on_opens_none(tmp_path: Path) -> None:
    path = tmp_path / "zenoh.json5"
    path.write_text("{mode: 'peer'}", encoding="utf-8")
    before = listening()
    with open_session(ZenohOptions(config_file=path)):
        assert listening() == before


@pytest.mark.parametrize("name", ["vehicle", "router"])
def test_shipped_files_listen_with_certificates_only(tmp_path: Path, name: str) -> None:
    files = secured(tmp_path / "keys")
    before = listening()
    with open_session(ZenohOptions(config_file=files.file(name))):
        port = int(files.endpoint.rpartition(":")[2])
        assert listening() - before == {("127.0.0.1", port)}


def test_all_shipped_files_are_tried() -> None:
    assert {path.stem for path in SHIPPED.glob("*.json5")} == {"vehicle", "companion", "operator", "router"}


CABLE = "/dev/ttyACM0,921600"


@pytest.mark.parametrize(
    ("zenoh", "device", "signs", "told"),
    [
        (ZenohOptions(), CABLE, False, []),
        (ZenohOptions(), "udpin:127.0.0.1:14540", False, []),
        (ZenohOptions(), "udpin:0.0.0.0:14540", True, []),
        (ZenohOptions(), "udpin:0.0.0.0:14540", False, ["MAVLink on udpin:0.0.0.0:14540 is not signed"]),
        (ZenohOptions(), "tcp:radio.local:5760", False, ["MAVLink on tcp:radio.local:5760 is not signed"]),
        (
            ZenohOptions(listen=("tcp/0.0.0.0:7447",), multicast_scouting=True, insecure=True),
            CABLE,
            False,
            ["Zenoh on tcp/0.0.0.0:7447 takes anybody", "Zenoh's multicast scouting meets anybody"],
        ),
    ],
)
def test_what_is_open_to_strangers_is_told_by_the_status_and_by_the_check(
    zenoh: ZenohOptions, device: str, signs: bool, told: list[str]
) -> None:
    assert list(open_links(zenoh, device, signs=signs)) == told
    findings = assess_links(told)
    assert {one.level for one in findings} == {Level.WARN if told else Level.PASS}
    assert all(opening in {one.found for one in findings} for opening in told)


def test_tls_without_access_control_is_told_and_the_shipped_files_leave_nothing_open(tmp_path: Path) -> None:
    files = secured(tmp_path / "keys")
    for name in ("vehicle", "router", "companion", "operator"):
        assert open_links(ZenohOptions(config_file=files.file(name)), CABLE, signs=False) == ()
    path = tmp_path / "no_rules.json5"
    text = "{listen: {endpoints: ['tls/0.0.0.0:7447']}, transport: {link: {tls: {enable_mtls: true}}}}"
    path.write_text(text, encoding="utf-8")
    assert open_links(ZenohOptions(config_file=path), CABLE, signs=False) == (
        "Zenoh on tls/0.0.0.0:7447 has no access control",
    )
