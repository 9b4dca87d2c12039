"""The command that makes keys: what only its owner may read, what is kept, and what a certificate says."""

from pathlib import Path

import pytest
from cryptography import x509

from companion.app import app
from companion.runtime.keys import NAMES
from link.mavlink.signing import read_key
from link.program.cli import run_app


def test_keys_are_made_for_all_who_meet_and_only_their_owner_may_read_them(tmp_path: Path) -> None:
    folder = tmp_path / "keys"
    assert run_app("companion", app, ["keys", str(folder), "--host", "192.168.4.1", "--host", "car.local"]) == 0
    expected = {f"{name}.{end}" for name in (*NAMES, "ca") for end in ("pem", "key")} | {"mavlink.key"}
    assert {path.name for path in folder.iterdir()} == expected
    assert {path.stat().st_mode & 0o077 for path in (folder, *folder.iterdir())} == {0}
    assert len(read_key(folder / "mavlink.key")) == 32


def test_certificate_is_signed_by_the_authority_for_its_name_and_hosts(tmp_path: Path) -> None:
    assert run_app("companion", app, ["keys", str(tmp_path), "--host", "192.168.4.1"]) == 0
    authority, vehicle = (
        x509.load_pem_x509_certificate((tmp_path / f"{name}.pem").read_bytes()) for name in ("ca", "vehicle")
    )
    vehicle.verify_directly_issued_by(authority)
    assert vehicle.subject.rfc4514_string() == "CN=vehicle"
    names = vehicle.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    assert {str(one.value) for one in names} == {"vehicle", "localhost", "127.0.0.1", "192.168.4.1"}


def test_further_certificate_is_signed_by_the_authority_that_is_there_and_nothing_is_overwritten(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["keys", str(tmp_path), "--name", "companion"]
    assert run_app("companion", app, arguments) == 0
    kept = {path: path.read_bytes() for path in tmp_path.iterdir()}
    assert run_app("companion", app, ["keys", str(tmp_path), "--name", "tablet"]) == 0
    assert run_app("companion", app, arguments) == 2
    assert "companion.key: exists" in capsys.readouterr().err
    assert {path: path.read_bytes() for path in kept} == kept
    (tmp_path / "ca.key").write_bytes(b"nonsense")
    assert run_app("companion", app, ["keys", str(tmp_path), "--name", "other"]) == 2
    assert "are no authority" in capsys.readouterr().err


@pytest.mark.parametrize("host", ["", "a b", "192.168.4.1:7447"])
def test_what_is_no_host_is_refused_before_anything_is_made(
    host: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "keys"
    assert run_app("companion", app, ["keys", str(folder), "--host", host]) == 2
    assert f"--host {host!r} is no name or address" in capsys.readouterr().err
    assert not folder.exists()
