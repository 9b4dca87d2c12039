"""What a command line that says little about Zenoh amounts to."""

import pytest

from link.zenoh.command_line import ZenohArguments
from link.zenoh.options import DEFAULT_ENDPOINT

HERE = (DEFAULT_ENDPOINT,)


@pytest.mark.parametrize(
    ("mode", "listens", "connect", "listen"),
    [
        (None, False, HERE, ()),
        ("client", False, HERE, ()),
        (None, True, (), HERE),
        ("router", True, (), HERE),
        ("client", True, (), ()),
    ],
)
def test_who_says_nothing_meets_at_the_default_endpoint(
    mode: str | None, listens: bool, connect: tuple[str, ...], listen: tuple[str, ...]
) -> None:
    options = ZenohArguments(mode=mode).options(listens=listens)
    assert (options.mode, options.connect, options.listen) == (mode, connect, listen)


@pytest.mark.parametrize("listens", [False, True])
def test_what_is_said_stands_alone(listens: bool) -> None:
    there = "tcp/192.0.2.5:7447"
    options = ZenohArguments(connect=[there]).options(listens=listens)
    assert (options.connect, options.listen) == ((there,), ())
