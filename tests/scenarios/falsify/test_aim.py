from collections.abc import Mapping

import numpy as np
import pytest

from scenarios.falsify.aim import Aim, aimed_start, plain_world
from scenarios.falsify.space import Z_MAX, radius_max, uniforms
from scenarios.falsify.strategy import EvolutionStrategy, Start

NAMES = (*(f"other.{index}" for index in range(40)), "event", "gap", "strength")
LONGEST_S = 20.0


def event_at(_seed: int, _chosen: Mapping[str, float], begins_s: float) -> Mapping[str, float] | None:
    return {"event": 0.8, "gap": begins_s / LONGEST_S} if 0.0 < begins_s < LONGEST_S else None


AIM = Aim(gap="gap", strength=("strength",), at=event_at)
PLAIN = plain_world(NAMES, 3, AIM)


def aimed(contact_s: float) -> Start | None:
    return aimed_start(NAMES, 3, AIM, PLAIN, contact_s=contact_s, margin=0.6)


def test_plain_world_is_plausible_and_its_event_comes_late() -> None:
    for seed in range(30):
        z = plain_world(NAMES, seed, AIM)
        assert np.linalg.norm(z) <= radius_max(len(NAMES)) * (1.0 + 1e-12)
        assert Z_MAX >= z[NAMES.index("gap")] > 2.5


def test_plain_world_of_no_seed_is_at_the_medians_but_for_its_event() -> None:
    assert np.flatnonzero(plain_world(NAMES, None, AIM)).tolist() == [NAMES.index("gap")]


def test_each_seed_has_another_plain_world() -> None:
    assert len({plain_world(NAMES, seed, AIM)[0] for seed in range(30)}) == 30


def test_aimed_events_begin_in_the_last_second_before_the_contact() -> None:
    start = aimed(5.3)
    assert start is not None
    points = [z for seed in range(50) for z in EvolutionStrategy(start, seed).ask()]
    leads_s = 5.3 - LONGEST_S * np.array([uniforms(NAMES, z)["gap"] for z in points])
    assert leads_s.mean() == pytest.approx(0.3, abs=0.02)
    assert leads_s.std() == pytest.approx(0.1, abs=0.02)
    assert ((leads_s > 0.0) & (leads_s < 1.0)).mean() > 0.99


def test_aim_leaves_all_but_the_event_as_it_was() -> None:
    start = aimed(5.3)
    assert start is not None
    assert start.mean[:40].tolist() == PLAIN[:40].tolist()
    assert start.spread[:41].tolist() == [0.0] * 41
    assert uniforms(NAMES, start.mean)["event"] == pytest.approx(0.8)
    assert start.margin == pytest.approx(0.3)


@pytest.mark.parametrize("contact_s", [-1.0, 0.35, LONGEST_S + 0.35])
def test_contact_that_no_event_can_come_before_is_not_aimed_at(contact_s: float) -> None:
    assert aimed(contact_s) is None
