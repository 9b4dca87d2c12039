"""A run over the wire: Ctrl-C, and how fast its simulator goes."""

import os
import signal

import pytest

from scenarios.wire.run import Pace, interrupted_between_polls


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


@pytest.mark.parametrize("speed", [0.5, 1.0, 3.0])
def test_simulator_that_starts_late_is_as_fast_as_it_goes_once_it_has_caught_up(speed: float) -> None:
    """It stands for 0.6 s at first, and is where it ought to be after 0.9 s."""
    pace = Pace()
    for tick in range(300):
        now_s = 0.01 * tick
        pace.update(100.0 + now_s, 0.0 if now_s < 0.6 else speed * min(now_s, 3.0 * (now_s - 0.6)))
    assert pace.factor == pytest.approx(speed)
