"""Data that contradict each other are counted over the last seconds, and told; outages and new beginnings are not."""

from collections.abc import Mapping

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind
from companion.core.data import Quantity
from companion.core.reasons import Reason, sentence
from companion.integrity.contradictions import Contradictions, contradicts_itself, update_contradictions
from companion.landing.decisions.feasibility import obstacle
from link.records import replace
from tests.companion.facts import CONFIG, NOW_NS, changed, situation
from tests.companion.health import health_of
from tests.companion.vehicle.drives import NOMINAL, straight
from tests.companion.vehicle.rides import arrivals, estimator, now_ns

HALF_NS = 500_000_000


def after(per_half_second: list[tuple[int, int]]) -> Contradictions:
    """Count measurements that came accepted and rejected, half a second after half a second."""
    return after_all({Quantity.POSITION: per_half_second})


def after_all(per_half_second: Mapping[Quantity, list[tuple[int, int]]]) -> Contradictions:
    """Count what came of each quantity likewise, as often of each."""
    counts, sums = Contradictions(), dict.fromkeys(per_half_second, (0, 0))
    counts = update_contradictions(counts, health_of(sums), NOW_NS)
    for k in range(len(next(iter(per_half_second.values())))):
        for quantity, came in per_half_second.items():
            sums[quantity] = (sums[quantity][0] + came[k][0], sums[quantity][1] + came[k][1])
        assert counts.is_due(NOW_NS + (k + 1) * HALF_NS)
        counts = update_contradictions(counts, health_of(sums), NOW_NS + (k + 1) * HALF_NS)
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


def test_what_fits_of_one_quantity_does_not_hide_what_does_not_of_another() -> None:
    counts = after_all({Quantity.POSITION: [(3, 2)] * 20, Quantity.ACCELERATION: [(50, 0)] * 20})
    assert counts.rejected_share == pytest.approx(0.4)
    assert counts.rejected is Quantity.POSITION


def test_of_slow_data_all_together_are_judged() -> None:
    once_a_second = [(1, 0), (0, 0)] * 6 + [(0, 1), (0, 0)] * 4
    slow = dict.fromkeys((Quantity.POSITION, Quantity.VELOCITY, Quantity.HEADING), once_a_second)
    assert after({**slow}[Quantity.POSITION]).rejected_share == 0.0
    assert after_all(slow).rejected_share == pytest.approx(0.4)
    assert after_all(slow).rejected is None


def test_sightings_and_the_drones_own_data_are_no_contradictions_of_the_vehicles() -> None:
    for quantity in (Quantity.PAD, Quantity.SURFACE):
        assert after_all({Quantity.POSITION: [(5, 0)] * 20, quantity: [(5, 5)] * 20}).rejected_share == 0.0


@pytest.mark.parametrize("false_of_four", [1, 2, 3])
def test_fixes_of_two_places_are_found_beside_a_velocity_and_a_heading_that_fit(false_of_four: int) -> None:
    chosen, fixes, memory, watch = estimator(EstimatorKind.IMM), 0, None, Contradictions()
    for measurement in arrivals(straight(5.0, 20.0), NOMINAL, 1):
        told = measurement
        if measurement.quantity is Quantity.POSITION:
            fixes += 1
            aside_m = 5.0 * (measurement.t_ns > now_ns(5.0) and fixes % 4 < false_of_four)
            told = replace(measurement, value=measurement.value + np.array([0.0, aside_m, 0.0]))
        memory = chosen.fuse(memory, [told])
        if watch.is_due(measurement.t_ns):
            watch = update_contradictions(watch, chosen.health(memory), measurement.t_ns)
    assert watch.rejected_share > CONFIG.integrity.rejected_share_max


def test_vehicle_contradicts_itself_by_more_than_the_share_that_is_set() -> None:
    share = CONFIG.integrity.rejected_share_max
    assert not contradicts_itself(changed(situation(), rejected_share=share - 0.01), CONFIG)
    assert contradicts_itself(changed(situation(), rejected_share=share + 0.01), CONFIG)


def test_estimate_that_begins_anew_is_counted_anew() -> None:
    before = after([(6, 4)] * 10)
    for accepted, rejected in ((3, 0), (50, 49)):
        health = health_of({Quantity.POSITION: (accepted, rejected)})
        anew = update_contradictions(before, health, NOW_NS + 10**10)
        assert len(anew.samples) == 1
        assert anew.rejected_share == 0.0
        assert anew.samples[0][0] == NOW_NS + 10**10
    goes_on = update_contradictions(before, health_of({Quantity.POSITION: (60, 40)}), NOW_NS + 10**10)
    assert goes_on.rejected_share == pytest.approx(0.4)


def test_it_is_due_every_half_second() -> None:
    counts = after([(10, 0)])
    assert not counts.is_due(NOW_NS + HALF_NS + HALF_NS - 1)
    assert counts.is_due(NOW_NS + HALF_NS + HALF_NS)
    assert Contradictions().is_due(0)


@pytest.mark.parametrize(
    ("quantity", "told", "remedy"),
    [
        (None, "data", "receiver"),
        (Quantity.VELOCITY, "velocities", "unit (m/s)"),
        (Quantity.HEADING, "headings", "unit (rad)"),
        (Quantity.ACCELERATION, "accelerations", "axes (FLU)"),
    ],
)
def test_it_keeps_a_landing_from_being_begun_and_says_what_is_rejected(
    quantity: Quantity | None, told: str, remedy: str
) -> None:
    facts = changed(situation(), rejected_share=0.41, rejected=quantity)
    known = obstacle({Reason.MEASUREMENTS_REJECTED: NOW_NS}, facts, CONFIG)
    assert known is not None
    assert sentence(known).startswith(f"vehicle data contradict themselves: 41% of its {told} in 10 s were rejected")
    assert remedy in sentence(known)
