"""The word where something takes long."""

import threading

import pytest

from link.program.cli import Patience


def test_a_slow_start_is_told_on_stderr_and_a_quick_one_is_not(capfd: pytest.CaptureFixture[str]) -> None:
    with Patience("tool", "waiting for the drone", after_s=30.0):
        pass
    assert capfd.readouterr().err == ""
    with Patience("tool", "waiting for the drone", after_s=0.0):
        for thread in threading.enumerate():
            if isinstance(thread, threading.Timer):
                thread.join(timeout=10.0)
    assert capfd.readouterr().err.startswith("tool: waiting for the drone")
