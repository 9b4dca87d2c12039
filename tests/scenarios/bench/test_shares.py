"""The shares of a run's processor time name who was at work."""

from collections import Counter

import pytest

from link.frames.rotations import rotate
from link.messages import Vector3
from scenarios.bench.shares import sampled_parts, shares_of

HALF_TURN = (0.0, 0.0, 0.0, 1.0)


@pytest.mark.slow
def test_package_that_computes_gets_the_samples() -> None:
    vector: Vector3 = (1.0, 2.0, 3.0)
    with sampled_parts() as counts:
        while counts["link.frames"] < 3:
            vector = rotate(HALF_TURN, vector)
    assert counts["link.frames"] >= 3
    assert not any(part.startswith("companion") for part in counts)


def test_shares_sum_to_one_with_the_largest_first() -> None:
    shares = shares_of(Counter({"link": 1, "companion.planning": 3}))
    assert list(shares.items()) == [("companion.planning", 0.75), ("link", 0.25)]
    assert shares_of(Counter()) == {}
