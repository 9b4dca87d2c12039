"""The pad's height by the drone's range finder."""

import pytest

from companion.integrity.heights import update_pad_raised_m, with_pad_raised
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from tests.companion.facts import CONFIG, changed, situation
from tests.companion.world import configured

BELIEVING = configured({"touchdown": {"range_finder": {"corrects_height": True}}})
STEPS = 200


def _settled(facts: Situation, phase: Phase = Phase.DESCEND) -> float:
    raised_m = 0.0
    for _ in range(STEPS):
        before_m, raised_m = raised_m, update_pad_raised_m(raised_m, phase, facts, BELIEVING)
        assert abs(raised_m - before_m) <= 0.5 / CONFIG.setpoints.rate_hz + 1e-12
    return raised_m


@pytest.mark.parametrize("off_m", [-0.7, 0.4])
def test_height_over_the_raised_pad_is_what_the_range_finder_sees(off_m: float) -> None:
    facts = changed(situation(1.2), range_height_m=1.2 - off_m)
    relative = with_pad_raised(facts, _settled(facts)).approach
    assert relative is not None
    assert relative.height_m == pytest.approx(1.2 - off_m)


@pytest.mark.parametrize(
    "facts",
    [
        changed(situation(1.2), range_height_m=None),
        changed(situation(1.2), range_height_m=2.7),
        changed(situation(1.2, 0.7), range_height_m=0.9),
    ],
)
def test_what_is_unseen_beside_the_pad_or_a_roof_away_raises_nothing(facts: Situation) -> None:
    assert _settled(facts) == 0.0


def test_pad_stays_where_the_vehicle_says_off_the_landing_and_without_being_asked() -> None:
    facts = changed(situation(1.2), range_height_m=0.9)
    assert _settled(facts, Phase.ABORT) == 0.0
    assert update_pad_raised_m(0.1, Phase.DESCEND, facts, CONFIG) == 0.0
