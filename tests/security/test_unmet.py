"""What a person is told whose certificates, address or date keep a session from coming about."""

from pathlib import Path

import pytest

from companion.runtime.keys import keys
from link.errors import UserError
from link.zenoh.session import ZenohOptions, open_session
from tests.security.secured import Secured, secured


@pytest.fixture
def files(tmp_path: Path) -> Secured:
    return secured(tmp_path / "ours")


def told(options: ZenohOptions) -> str:
    with pytest.raises(UserError) as caught:
        open_session(options)
    assert "\n" not in str(caught.value)
    return str(caught.value)


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
        by_its_file = ZenohOptions(mode="client", config_file=files.file("companion"))
        assert "not valid for '127.0.0.2'" in told(
            ZenohOptions(mode="client", config_file=files.file("companion"), connect=(elsewhere,))
        )
        open_session(by_its_file).close()
        assert "its certificate is refused (" in told(
            ZenohOptions(mode="client", config_file=files.file("companion", authority=other))
        )
        assert "it refuses this certificate (" in told(
            ZenohOptions(mode="client", config_file=tmp_path / "mixed.json5")
        )
        assert "not met as tcp/" in told(ZenohOptions(mode="client", connect=(files.endpoint.replace("tls/", "tcp/"),)))


@pytest.mark.slow
def test_certificate_beside_another_ones_key_and_a_router_without_tls_are_told(files: Secured) -> None:
    config = files.file("companion").read_text(encoding="utf-8").replace("companion.key", "operator.key")
    (files.folder / "wrong_key.json5").write_text(config, encoding="utf-8")
    plain = files.endpoint.replace("tls/", "tcp/")
    with open_session(ZenohOptions(listen=(plain,))):
        assert "not met as tls/" in told(ZenohOptions(mode="client", config_file=files.file("companion")))
        assert "cannot be used" in told(ZenohOptions(mode="client", config_file=files.folder / "wrong_key.json5"))
