"""What a station is scored by: where the companion says that it keeps it; what is refused is no station."""

import math

import pytest

from companion.situation.phases import Phase
from link.messages import BodyTruth, CommandReply, Station, StationFrame, Vector3
from link.records import replace
from scenarios.sortie.flight import HELD_S, SortieFlight
from scenarios.sortie.score import SETTLING_S, score_sortie
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


class _Flown(SortieFlight):
    """A drone that stays `OFF_M` above the station that it keeps, from the order on."""

    def __init__(self, kept_m: Vector3 | None) -> None:
        super().__init__(sortie_scenario("straight_10", 1, "px4"), 1)
        self.orders.append((0, ORDERED))
        ahead_m, left_m, up_m = ORDERED.offset_m if kept_m is None else kept_m
        up_m += OFF_M + self.scenario.vehicle.roof_height_m + GEAR_HEIGHT_M
        for t_ns in range(0, round(HELD_S * 1e9), 100_000_000):
            self.recording.add(body(t_ns, (ahead_m, left_m, up_m)))
            self.recording.add(body(t_ns, (0.0, 0.0, 0.0)), is_drone=False)
            self.recording.add(replace(status_of(t_ns, Phase.FOLLOW), station_offset_m=kept_m))
        self.times_ns["hold"] = round(HELD_S * 1e9)

    def answer(self, *, accepted: bool) -> None:
        """Take the companion's answer to the order, before the hold."""
        hold_ns = self.times_ns.pop("hold")
        self._take([CommandReply(accepted=accepted, reason="" if accepted else "too low")])
        self.times_ns["hold"] = hold_ns


@pytest.mark.parametrize(("kept_m", "moved_m"), [(KEPT_M, math.dist(KEPT_M, ORDERED.offset_m)), (None, 0.0)])
def test_station_is_off_by_its_distance_from_where_it_is_kept(kept_m: Vector3 | None, moved_m: float) -> None:
    flight = _Flown(kept_m)
    flight.answer(accepted=True)
    score = score_sortie(flight, "follow")
    assert HELD_S > SETTLING_S
    assert score.error_straight_m == pytest.approx(OFF_M)
    assert score.error_bend_m is None
    assert score.moved_m == pytest.approx(moved_m)
    assert score.refused == 0


def test_station_that_is_refused_is_counted_and_scored_by_nothing() -> None:
    flight = _Flown(KEPT_M)
    flight.answer(accepted=False)
    score = score_sortie(flight, "follow")
    assert (score.error_straight_m, score.moved_m, score.refused) == (None, None, 1)
