"""A drone that the pad has stopped at once, as hard ground does, while the pad drives on: whole steps."""

import pytest

from companion.core.data import RangeReading
from companion.situation.phases import Phase
from link.messages import Vector3
from link.records import replace
from tests.companion.facts import changed
from tests.companion.world import CONFIG, DISARM, GEAR_M, STEP_NS, Flight, configured, reached

FORCED = 21196.0
HOLD_S = CONFIG.touchdown.stopped_hold_s
# What a stop does to an estimator: it goes on believing in a sinking or a climb for seconds.
WRONG_M_S: Vector3 = (0.1, -0.2, -0.35)


def _just_above_the_pad() -> Flight:
    flight = reached(Phase.DESCEND)
    while flight.own.position_enu_m[2] - GEAR_M > flight.vehicle.at(flight.t_ns)[2] + 0.03:
        flight.step()
    assert flight.phase is Phase.DESCEND
    return flight


def _held(flight: Flight, *, falls_m_s2: float, jolt_m_s2: float | None) -> None:
    """The drone where it is, still fast down by its own estimate, for one step."""
    flight.own_is_silent = True
    flight.own = replace(
        flight.own,
        t_ns=flight.t_ns,
        velocity_enu_m_s=WRONG_M_S,
        acceleration_up_m_s2=-falls_m_s2,
        jolt_m_s2=jolt_m_s2,
    )
    flight.step()


def _jolted(seen_m: float | None) -> Flight:
    """The drone just above the pad after a jolt; its range finder, if there is one, sees something under its feet."""
    flight = _just_above_the_pad()
    if seen_m is not None:
        distance_m = seen_m + CONFIG.touchdown.range_finder.height_m
        range_down = RangeReading(t_ns=flight.t_ns, distance_m=distance_m, own=flight.own)
        flight.view = replace(flight.view, range_down=range_down)
    _held(flight, falls_m_s2=-3.0, jolt_m_s2=80.0)
    return flight


def _stopped(seen_m: float | None = 0.02) -> Flight:
    flight = _jolted(seen_m)
    assert flight.phase is Phase.TOUCHDOWN
    assert flight.memory.progress.stopped_by_pad
    return flight


def _forced_after_s(flight: Flight, *, falls_m_s2: float, limit_s: float = 2.0) -> float | None:
    """When the motors are forced off, since the contact."""
    contact_ns = flight.memory.progress.since_ns
    while (flight.monotonic_ns - contact_ns) * 1e-9 < limit_s and flight.phase is Phase.TOUCHDOWN:
        _held(flight, falls_m_s2=falls_m_s2, jolt_m_s2=0.3)
        if (Phase.TOUCHDOWN, DISARM, 0.0, FORCED) in flight.commands:
            return (flight.monotonic_ns - STEP_NS - contact_ns) * 1e-9
    return None


@pytest.mark.slow
@pytest.mark.parametrize("seen_m", [0.02, None])
def test_motors_go_off_though_the_pad_has_left_and_the_estimate_still_sinks(seen_m: float | None) -> None:
    after_s = _forced_after_s(_stopped(seen_m), falls_m_s2=0.4)
    assert after_s is not None
    assert HOLD_S <= after_s <= HOLD_S + 0.25  # a disarm is asked for again every 0.2 s


def test_jolt_that_the_range_finder_contradicts_is_none_of_the_pad() -> None:
    assert not _jolted(CONFIG.touchdown.range_finder.contact_height_max_m + 0.05).memory.progress.stopped_by_pad


def test_motors_stay_on_where_nothing_holds_the_drone_up() -> None:
    assert _forced_after_s(_stopped(), falls_m_s2=CONFIG.touchdown.falling_acceleration_m_s2 + 0.1) is None


def test_every_fall_begins_the_hold_anew() -> None:
    flight = _stopped()
    begin_ns = flight.t_ns
    while (flight.t_ns - begin_ns) * 1e-9 < HOLD_S - 0.05:
        _held(flight, falls_m_s2=0.0, jolt_m_s2=0.3)
    _held(flight, falls_m_s2=7.0, jolt_m_s2=0.3)
    fell_ns = flight.t_ns
    assert _forced_after_s(flight, falls_m_s2=0.0) is not None
    assert (flight.t_ns - fell_ns) * 1e-9 >= HOLD_S


@pytest.mark.slow
@pytest.mark.parametrize("change", ["no jolt", "position only", "lifted"])
def test_evidence_is_the_jolt_the_press_and_the_pads_height_together(change: str) -> None:
    flight = _stopped()
    match change:
        case "no jolt":
            flight.memory = changed(flight.memory, stopped_by_pad=False)
        case "position only":
            flight.config = configured({"setpoints": {"position_only": True}})
        case "lifted":
            x, y, z = flight.own.position_enu_m
            lifted_m = CONFIG.descent.commit_height_m + 0.05
            flight.own = replace(flight.own, position_enu_m=(x, y, z + lifted_m))
    assert _forced_after_s(flight, falls_m_s2=0.4) is None
