"""What `scenarios attack` prints, and how it ends."""

import json
import socket
from collections.abc import Iterator

import pytest
from typer.testing import CliRunner

from link.errors import UserError
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions
from scenarios.app import app
from scenarios.attack import crafted, live, spoofs
from scenarios.attack.attempt import Attempt


def tried(seen: str) -> Iterator[Attempt]:
    yield Attempt(by="MAVLink", what="forges mode", expected="changes nothing", seen=seen)


@pytest.mark.parametrize(("seen", "code"), [("changes nothing", 0), ("changes armed", 1)])
def test_attack_ends_with_one_where_something_else_is_seen_than_expected(
    seen: str, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(spoofs, "attempts", lambda: tried(seen))
    monkeypatch.setattr(crafted, "attempts", lambda: tried("changes nothing"))
    result = CliRunner().invoke(app, ["attack", "--json"])
    rows = json.loads(result.stdout)["attempts"]
    assert [row["right"] for row in rows] == [code == 0, True]
    assert rows[0]["seen"] == seen
    told = CliRunner().invoke(app, ["attack"])
    assert told.stdout.splitlines()[-1] == f"{2 - code} of 2 are right"
    assert ("WRONG: changes nothing was expected" in told.stdout) is (code == 1)


def test_stranger_that_tries_where_nothing_listens_is_a_mistake_and_no_attempt() -> None:
    with socket.create_server(("127.0.0.1", 0)) as once:
        endpoint = f"tls/127.0.0.1:{once.getsockname()[1]}"
    with pytest.raises(UserError, match=f"{endpoint}: nothing listens there"):
        next(live.attempts(ZenohOptions(), Keys(), device=None, stranger=endpoint))
