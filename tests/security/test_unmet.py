"""What a person is told whose certificates, address or date keep a session from coming about."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from companion.runtime.keys import keys
from link.errors import UserError
from link.zenoh.session import ZenohOptions, open_session
from tests.security.secured import Secured, secured


@pytest.fixture
def files(tmp_path: Path) -> Secured:
    return secured(tmp_path / "ours")


def told(*options: ZenohOptions) -> list[str]:
    """Return what each session that does not come about says; all at once, since each is waited for."""
    with ThreadPoolExecutor(len(options)) as openers:
        return list(openers.map(_told, options))


def _told(options: ZenohOptions) -> str:
    with pytest.raises(UserError) as caught:
        open_session(options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


def client(config_file: Path) -> ZenohOptions:
    return ZenohOptions(mode="client", config_file=config_file)


@pytest.mark.slow
def test_mistakes_with_certificates_are_told_each_by_its_own_reason(files: Secured, tmp_path: Path) -> None:
    other = tmp_path / "other"
    keys(other, host=[])
    mixed = (
        files.file("companion").read_text(encoding="utf-8").replace(f"{files.folder}/companion", f"{other}/companion")
    )
    (tmp_path / "mixed.json5").write_text(mixed, encoding="utf-8")
    elsewhere = files.endpoint.replace("127.0.0.1", "127.0.0.2")
    listens = files.endpoint.replace("127.0.0.1", "0.0.0.0")  # noqa: S104 (all of loopback's addresses)
    with open_session(ZenohOptions(config_file=files.file("vehicle"), listen=(listens,))):
        open_session(client(files.file("companion"))).close()
        name, refused, refuses, plain = told(
            ZenohOptions(mode="client", config_file=files.file("companion"), connect=(elsewhere,)),
            client(files.file("companion", authority=other)),
            client(tmp_path / "mixed.json5"),
            ZenohOptions(mode="client", connect=(files.endpoint.replace("tls/", "tcp/"),)),
        )
    assert "not valid for '127.0.0.2'" in name
    assert "its certificate is refused (" in refused
    assert "it refuses this certificate (" in refuses
    assert "not met as tcp/" in plain


@pytest.mark.slow
def test_certificate_beside_another_ones_key_and_a_router_without_tls_are_told(files: Secured) -> None:
    config = files.file("companion").read_text(encoding="utf-8").replace("companion.key", "operator.key")
    (files.folder / "wrong_key.json5").write_text(config, encoding="utf-8")
    plain = files.endpoint.replace("tls/", "tcp/")
    with open_session(ZenohOptions(listen=(plain,))):
        without_tls, wrong_key = told(client(files.file("companion")), client(files.folder / "wrong_key.json5"))
    assert "not met as tls/" in without_tls
    assert "cannot be used" in wrong_key
