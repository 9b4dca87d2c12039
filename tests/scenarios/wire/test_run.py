"""Ctrl-C in a run over the wire."""

import os
import signal

import pytest

from scenarios.wire.run import interrupted_between_polls


def test_interrupt_breaks_into_nothing_and_ends_the_run_at_the_next_poll() -> None:
    """One that met a text which runs as code, as a decoder's that is made, had CPython end by the signal at last."""
    before, went_on = signal.getsignal(signal.SIGINT), False
    with interrupted_between_polls() as check_interrupt:
        check_interrupt()
        exec(f"os.kill({os.getpid()}, signal.SIGINT)")  # noqa: S102 (what is tested)
        went_on = True
        with pytest.raises(KeyboardInterrupt):
            check_interrupt()
    assert went_on
    assert signal.getsignal(signal.SIGINT) is before
