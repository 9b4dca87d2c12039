"""The approach after one that was broken off on purpose lands, and the climb between them ends where it is meant to."""

import pytest

from scenarios.faults.retry import RetryCase, fly_retry


@pytest.mark.slow
def test_approach_after_one_that_was_broken_off_on_arducopter_lands() -> None:
    retried = fly_retry(RetryCase(scenario="straight_5", firmware="ardupilot", height_m=0.3, seed=1))
    assert retried.lands_at_once, retried
    assert retried.overshoot_m is not None
    assert retried.overshoot_m < 0.5


@pytest.mark.slow
def test_descent_that_never_comes_so_low_is_not_broken_off() -> None:
    retried = fly_retry(RetryCase(scenario="straight_5", firmware="px4", height_m=-1.0, seed=1))
    assert retried.overshoot_m is None
    assert not retried.lands_at_once
