"""Flying a mission: which item is current, whether it is done, and where it sends the flight."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from math import dist, hypot, isfinite, nan, pi, radians, tau
from types import MappingProxyType

from link.frames.geodesy import Datum
from link.mavlink.dialect import mavlink
from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.modes import Mode
from sim_autopilot.core.settings import FlightSettings
from sim_autopilot.flight.flight import Leg, ModeFlight, begin, climb_to, descend_here, go_to
from sim_autopilot.flight.travel import Goal
from sim_autopilot.missions.items import Item, place_of
from sim_autopilot.plant.snapshot import Snapshot

_CLIMBED_M = 0.5
_AT_M = 0.5
"""How near to the place of a landing the drone comes before it descends."""
_WAYPOINT = int(mavlink.MAV_CMD_NAV_WAYPOINT)
_TAKEOFF = int(mavlink.MAV_CMD_NAV_TAKEOFF)
_LAND = int(mavlink.MAV_CMD_NAV_LAND)
_RETURN = int(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH)
_DELAY = int(mavlink.MAV_CMD_NAV_DELAY)
_UNLIMITED = int(mavlink.MAV_CMD_NAV_LOITER_UNLIM)
_TIMED = int(mavlink.MAV_CMD_NAV_LOITER_TIME)
_PLACES = frozenset({_WAYPOINT, _TAKEOFF, _LAND, _UNLIMITED, _TIMED})
_FLOWN_AS: Mapping[int, int] = MappingProxyType(
    {
        mavlink.MAV_CMD_NAV_LOITER_TURNS: _TIMED,  # it stays as long as the turns would take
        mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT: _WAYPOINT,
        mavlink.MAV_CMD_NAV_LOITER_TO_ALT: _WAYPOINT,
        mavlink.MAV_CMD_NAV_VTOL_TAKEOFF: _TAKEOFF,
        mavlink.MAV_CMD_NAV_VTOL_LAND: _LAND,
    }
)
_TURN_RADIUS_M = 10.0


class Stage(Enum):
    """How far the current item is."""

    NEW = 0
    RISING = 1
    GOING = 2
    STAYING = 3
    LANDING = 4
    FINISHED = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """How far the mission is.

    Attributes:
        index: of the current item.
        stage: of the current item.
        staying_ns: since when it stays there, in ns since boot.
        speed_m_s: that the mission has asked for.
        jumps: how often each DO_JUMP was obeyed.
        started: whether it was ever flown.
    """

    index: int = 0
    stage: Stage = Stage.NEW
    staying_ns: int = 0
    speed_m_s: float | None = None
    jumps: Mapping[int, int] = field(default_factory=lambda: MappingProxyType({}))
    started: bool = False


NO_PROGRESS = Progress()


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """What a mission is flown in: the world's datum, home, what the parameters say, and what the drone does."""

    datum: Datum
    home_enu_m: Vector3
    settings: FlightSettings
    now: Snapshot
    landed: bool
    returns_itself: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class MissionStep:
    """What a step leads to: `reached` are the items that were just finished, `returns` asks for the return mode."""

    progress: Progress
    flight: ModeFlight
    reached: tuple[int, ...] = ()
    returns: bool = False


def fly_mission(progress: Progress, items: tuple[Item, ...], flight: ModeFlight, around: Surroundings) -> MissionStep:
    """Return how far the mission is now and where it sends the flight.

    Args:
        progress: after the last step.
        items: of the mission.
        flight: of the mission mode.
        around: what it is flown in.
    """
    progress = replace(progress, started=True)
    reached: list[int] = []
    for _ in range(len(items) + 1):
        if progress.stage is Stage.FINISHED or progress.index >= len(items):
            break
        index, item = progress.index, _as_flown(items[progress.index], around)
        if item.command == _RETURN and around.returns_itself:
            step = _return_home(progress, flight, around)
            return replace(step, reached=(*reached, *step.reached))
        if item.command == _RETURN:
            after = replace(progress, stage=Stage.FINISHED)
            return MissionStep(progress=after, flight=flight, reached=(*reached, index), returns=True)
        progress, flight = _pursue(progress, item, flight, around)
        if not _is_done(progress, item, around):
            break
        reached.append(index)
        progress = _next(progress, items)
    return MissionStep(progress=progress, flight=flight, reached=tuple(reached))


def _as_flown(item: Item, around: Surroundings) -> Item:
    """Return the item as which it is flown: one without a wing takes off, lands and passes as on its rotors."""
    command = _FLOWN_AS.get(item.command)
    if command is None:
        return item
    time_s = 0.0
    if item.command == mavlink.MAV_CMD_NAV_LOITER_TURNS:
        radius_m = abs(item.number(3)) or _TURN_RADIUS_M
        time_s = tau * radius_m * item.number(1) / around.settings.travel.cruise_m_s
    elif item.command == mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT:
        time_s = item.number(1)
    return replace(item, command=command, parameters=(time_s, 0.0, 0.0, nan))


def _return_home(progress: Progress, flight: ModeFlight, around: Surroundings) -> MissionStep:
    """Return to home and land there, without another mode, as ArduCopter does."""
    if progress.stage is not Stage.LANDING:
        back = begin(Mode.RTL, around.now, around.home_enu_m, around.settings)
        return MissionStep(progress=replace(progress, stage=Stage.LANDING), flight=replace(back, returns=True))
    if not around.landed:
        return MissionStep(progress=progress, flight=flight)
    return MissionStep(progress=replace(progress, stage=Stage.FINISHED), flight=flight, reached=(progress.index,))


def resume(progress: Progress) -> Progress:
    """Return the progress of a mission that is taken up again: its current item restarts."""
    return progress if progress.stage is Stage.FINISHED else replace(progress, stage=Stage.NEW)


def set_to(progress: Progress, index: int) -> Progress:
    """Return the progress of a mission sent to item `index`."""
    return replace(progress, index=index, stage=Stage.NEW)


def _pursue(progress: Progress, item: Item, flight: ModeFlight, around: Surroundings) -> tuple[Progress, ModeFlight]:
    now = around.now
    if item.command == _DELAY:
        if progress.stage is Stage.NEW:
            progress = replace(progress, stage=Stage.STAYING, staying_ns=now.boot_ns)
        return progress, flight
    if item.command not in _PLACES:
        return _obey(progress, item), flight
    goal = _goal(progress, item, around)
    if progress.stage is Stage.NEW and (around.landed or item.command == _TAKEOFF):
        progress, flight = replace(progress, stage=Stage.RISING), _rise(item, goal, flight, around)
    if progress.stage is Stage.NEW or (progress.stage is Stage.RISING and _has_climbed(flight, around)):
        progress = replace(progress, stage=Stage.GOING)
    if progress.stage is Stage.GOING:
        flight = go_to(flight, goal, now)
        if _is_there(item, goal, around):
            progress = replace(progress, stage=Stage.STAYING, staying_ns=now.boot_ns)
    if item.command == _LAND and progress.stage is Stage.STAYING:
        progress, flight = replace(progress, stage=Stage.LANDING), descend_here(flight, now)
    return progress, flight


def _rise(item: Item, goal: Goal, flight: ModeFlight, around: Surroundings) -> ModeFlight:
    height_m = goal.position_enu_m[2]
    if item.command != _TAKEOFF:
        height_m = max(height_m, around.home_enu_m[2] + around.settings.takeoff.height_m)
    return climb_to(flight, height_m, around.now)


def _has_climbed(flight: ModeFlight, around: Surroundings) -> bool:
    place = flight.anchor.position_enu_m
    high = place is None or around.now.position_enu_m[2] > float(place[2]) - _CLIMBED_M
    return flight.leg is Leg.CLIMB and not around.landed and high


def _goal(progress: Progress, item: Item, around: Surroundings) -> Goal:
    place = place_of(item, around.datum, around.home_enu_m)
    if not item.has_place:
        place = (*around.now.position_enu_m[:2], place[2])
    if item.command == _LAND:
        place = (place[0], place[1], max(place[2], around.now.position_enu_m[2]))
    speed_m_s = around.settings.travel.cruise_m_s if progress.speed_m_s is None else progress.speed_m_s
    yaw_deg = item.number(4, nan)
    yaw_rad = pi / 2.0 - radians(yaw_deg) if isfinite(yaw_deg) else None
    return Goal(position_enu_m=place, speed_m_s=speed_m_s, yaw_rad=yaw_rad)


def _is_there(item: Item, goal: Goal, around: Surroundings) -> bool:
    x, y, z = around.now.position_enu_m
    gx, gy, gz = goal.position_enu_m
    if item.command == _LAND:
        return dist((x, y), (gx, gy)) < _AT_M
    wanted_m = item.number(2) if item.command == _WAYPOINT else 0.0
    within_m = wanted_m if wanted_m > 0.0 else around.settings.travel.reached_m
    return hypot(x - gx, y - gy) < within_m and abs(z - gz) < around.settings.travel.reached_height_m


def _is_done(progress: Progress, item: Item, around: Surroundings) -> bool:
    if item.command == _LAND:
        return progress.stage is Stage.LANDING and around.landed
    if progress.stage is not Stage.STAYING or item.command == _UNLIMITED:
        return False
    stay_s = item.number(1) if item.command in {_WAYPOINT, _TIMED, _DELAY} else 0.0
    return (around.now.boot_ns - progress.staying_ns) * 1e-9 >= stay_s


def _obey(progress: Progress, item: Item) -> Progress:
    """Take an item that is done at once; those about cameras and gimbals, which it has not, change nothing."""
    if item.command == mavlink.MAV_CMD_DO_CHANGE_SPEED and item.number(2) > 0.0:
        progress = replace(progress, speed_m_s=item.number(2))
    return replace(progress, stage=Stage.STAYING)


def _next(progress: Progress, items: tuple[Item, ...]) -> Progress:
    index, item = progress.index, items[progress.index]
    following, jumps = index + 1, progress.jumps
    if item.command == mavlink.MAV_CMD_DO_JUMP:
        times, target = round(item.number(2)), round(item.number(1))
        done = jumps.get(index, 0)
        if 0 <= target < len(items) and (times < 0 or done < times):
            following, jumps = target, {**jumps, index: done + 1}
    if following >= len(items):
        return replace(progress, stage=Stage.FINISHED)
    return replace(progress, index=following, stage=Stage.NEW, jumps=jumps)
