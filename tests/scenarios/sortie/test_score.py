"""What a station is scored by: where the companion says that it keeps it; what is refused is no station."""

import math

import pytest

from companion.situation.phases import Phase
from link.messages import BodyTruth, CommandReply, Station, StationFrame, Vector3
from link.records import replace
from scenarios.recordings.recording import Recording
from scenarios.scoring.touchdown import rules_of
from scenarios.sortie.score import SETTLING_S, SortieScore, score_sortie
from scenarios.sortie.script import HELD_S, SortieOperator
from scenarios.sortie.task import sortie_scenario
from sim_autopilot.physics.contact import GEAR_HEIGHT_M
from tests.scenarios.statuses import status_of

ORDERED = Station(offset_m=(2.0, 6.0, 1.0), frame=StationFrame.VEHICLE)
KEPT_M = (2.5, 7.5, 1.8)
OFF_M = 0.2


def body(t_ns: int, position_enu_m: Vector3) -> BodyTruth:
    """Upright, looking east, at rest."""
    return BodyTruth(
        t_ns=t_ns,
        position_enu_m=position_enu_m,
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        velocity_flu_m_s=(0.0, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


class _Flown:
    """A drone that stays `OFF_M` above the station that it keeps, from the order on, and is heard of late."""

    def __init__(self, kept_m: Vector3 | None, *, speed_m_s: float = 0.0, late_ns: int = 0) -> None:
        self.scenario = sortie_scenario("straight_10", 1, "px4")
        self.operator = SortieOperator((ORDERED,))
        self.recording = Recording()
        order = self.operator.order(0, Phase.FOLLOW, 0.0, may_launch=False)
        assert order is not None
        assert order.station == ORDERED
        ahead_m, left_m, up_m = ORDERED.offset_m if kept_m is None else kept_m
        up_m += OFF_M + self.scenario.vehicle.roof_height_m + GEAR_HEIGHT_M
        for t_ns in range(0, round(HELD_S * 1e9), 100_000_000):
            drone_ns = t_ns + late_ns
            self.recording.add(body(drone_ns, (ahead_m + speed_m_s * drone_ns * 1e-9, left_m, up_m)))
            self.recording.add(body(t_ns, (speed_m_s * t_ns * 1e-9, 0.0, 0.0)), is_drone=False)
            self.recording.add(replace(status_of(t_ns, Phase.FOLLOW), station_offset_m=kept_m))

    def score(self, *, accepted: bool = True) -> SortieScore:
        """Take the companion's answer to the order, hold, and return the score."""
        self.operator.hear([CommandReply(accepted=accepted, reason="" if accepted else "too low")])
        assert self.operator.order(round(HELD_S * 1e9), Phase.FOLLOW, 0.0, may_launch=False) is not None
        return score_sortie(self.recording, self.operator, rules_of(self.scenario), "follow")


@pytest.mark.parametrize(("kept_m", "moved_m"), [(KEPT_M, math.dist(KEPT_M, ORDERED.offset_m)), (None, 0.0)])
def test_station_is_off_by_its_distance_from_where_it_is_kept(kept_m: Vector3 | None, moved_m: float) -> None:
    score = _Flown(kept_m).score()
    assert HELD_S > SETTLING_S
    assert score.error_straight_m == pytest.approx(OFF_M)
    assert score.error_by_station_m == pytest.approx((OFF_M,))
    assert score.error_bend_m is None
    assert score.moved_m == pytest.approx(moved_m)
    assert score.refused == 0


def test_truths_of_different_times_are_compared_at_the_drones() -> None:
    score = _Flown(KEPT_M, speed_m_s=8.0, late_ns=30_000_000).score()
    assert score.error_straight_m == pytest.approx(OFF_M)


def test_station_that_is_refused_is_counted_and_scored_by_nothing() -> None:
    score = _Flown(KEPT_M).score(accepted=False)
    assert (score.error_straight_m, score.error_by_station_m, score.moved_m, score.refused) == (None, (None,), None, 1)
