"""Data that contradict each other are counted over the last seconds, and told; outages and new beginnings are not."""

import pytest

from companion.core.reasons import Reason, sentence
from companion.integrity.vehicle_data import Contradictions, contradicts_itself, update_contradictions
from companion.landing.decisions.feasibility import obstacle
from companion.vehicle.estimator import BufferHealth
from tests.companion.facts import CONFIG, NOW_NS, changed, situation

HALF_NS = 500_000_000


def health(fused: int, gated: int) -> BufferHealth:
    return BufferHealth(fused=fused, gated=gated, late=0, recoveries=0, nis_per_dof=None, nis_dof=0)


def after(per_half_second: list[tuple[int, int]]) -> Contradictions:
    """Count measurements that came accepted and rejected, half a second after half a second."""
    counts, fused, gated = update_contradictions(Contradictions(), health(0, 0), NOW_NS), 0, 0
    for k, (accepted, rejected) in enumerate(per_half_second):
        fused, gated = fused + accepted, gated + rejected
        assert counts.is_due(NOW_NS + (k + 1) * HALF_NS)
        counts = update_contradictions(counts, health(fused, gated), NOW_NS + (k + 1) * HALF_NS)
    return counts


def test_share_is_of_the_last_ten_seconds() -> None:
    assert after([(10, 0)] * 30 + [(6, 4)] * 20).rejected_share == pytest.approx(0.4)
    assert after([(6, 4)] * 30 + [(10, 0)] * 20).rejected_share == 0.0
    assert after([(10, 0)] * 5 + [(6, 4)] * 5).rejected_share == pytest.approx(0.2)


def test_what_came_before_the_last_ten_seconds_is_forgotten_by_the_half_second() -> None:
    for quiet, share in ((19, 10.0 / 200.0), (20, 0.0)):
        assert after([(10, 0)] * 5 + [(0, 10)] + [(10, 0)] * quiet).rejected_share == pytest.approx(share)


def test_of_fewer_than_twenty_measurements_nothing_is_said() -> None:
    assert after([(2, 2)] * 4 + [(2, 1)]).rejected_share == 0.0
    assert after([(2, 2)] * 5).rejected_share == 0.5


def test_vehicle_contradicts_itself_by_more_than_the_share_that_is_set() -> None:
    share = CONFIG.integrity.rejected_share_max
    assert not contradicts_itself(changed(situation(), rejected_share=share - 0.01), CONFIG)
    assert contradicts_itself(changed(situation(), rejected_share=share + 0.01), CONFIG)


def test_estimate_that_begins_anew_is_counted_anew() -> None:
    before = after([(6, 4)] * 10)
    for health_now in (health(3, 0), health(59, 50)):
        anew = update_contradictions(before, health_now, NOW_NS + 10**10)
        assert anew == Contradictions(samples=((NOW_NS + 10**10, health_now.fused, health_now.gated),))
    assert update_contradictions(before, health(60, 40), NOW_NS + 10**10).rejected_share == pytest.approx(0.4)


def test_it_is_due_every_half_second() -> None:
    counts = after([(10, 0)])
    assert not counts.is_due(NOW_NS + HALF_NS + HALF_NS - 1)
    assert counts.is_due(NOW_NS + HALF_NS + HALF_NS)
    assert Contradictions().is_due(0)


def test_it_keeps_a_landing_from_being_begun_and_is_told_with_the_share() -> None:
    facts = changed(situation(), rejected_share=0.41)
    known = obstacle({Reason.MEASUREMENTS_REJECTED: NOW_NS}, facts, CONFIG)
    assert known is not None
    assert sentence(known).startswith(
        "vehicle data contradict themselves: 41 % of the last 10 s' measurements were rejected"
    )
