"""How the driver of a world drives its road: speed, stops, brakes, lane changes and swerves.

The driver follows the planned speed, until events happen at random times: the vehicle stops and stands, slows down
behind another one, brakes hard, changes the lane, or swerves. Between the places of the plan's grid the acceleration is
constant, so the drive is a list of legs; neighbouring cells of equal acceleration become one leg.
Braking keeps within the friction circle: what the bend takes is not left for the brakes.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from scenarios.simulation.noise import Seed
from scenarios.tracks.drive import Shift
from scenarios.tracks.drive_config import SHIFT_CURVATURE
from scenarios.worlds.draws import Draws
from scenarios.worlds.road import STEERING_MAX_PER_M_S, TURN_RADIUS_MIN_M, RoadPlan
from scenarios.worlds.speed_plan import Grid, plan_speed

EVENTS = 8
DRIVE_S = 140.0
"""From departure to the final stop: longer than a run, which lasts 120 s and 30 s to break off."""
_GRIP_USED_MAX = 0.95  # of the friction circle; a driver at the limit of grip is a skid, which is not modelled
_GRIP_SHIFT_MAX = 0.75  # of a lane change or a swerve, which leaves some for speeding up; a choice
_SAME_M_S2 = 1e-7
_STRAIGHT_PER_M = 1e-6
_CRAWL_M_S = 0.2  # slower than this a vehicle stands
_AHEAD_MAX_M = 400.0  # a lane change waits so far for a straight road

Leg = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivePlan:
    """A drive in numbers: legs (s, m/s^2), shifts (m, m, m), and how many events of each kind it came to."""

    legs: list[Leg]
    shifts: list[Shift]
    counts: dict[str, int]
    passes_s: float
    first_event_s: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class _Event:
    kind: str
    gap_s: float
    deceleration_m_s2: float
    speed_share: float
    standing_s: float
    offset_m: float
    lateral_m_s2: float


@dataclass(slots=True)
class _Drive:
    """A drive that grows cell by cell."""

    cells: list[tuple[float, float, float]] = field(default_factory=list)  # duration, speed before and after
    t_s: float = 0.0
    place: int = 0
    speed_m_s: float = 0.0

    def go(self, step_m: float, after_m_s: float) -> None:
        """Drive one cell with constant acceleration."""
        duration_s = 2.0 * step_m / (self.speed_m_s + after_m_s)
        self.cells.append((duration_s, self.speed_m_s, after_m_s))
        self.t_s += duration_s
        self.place += 1
        self.speed_m_s = after_m_s

    def stand(self, duration_s: float) -> None:
        """Stand still."""
        self.cells.append((duration_s, 0.0, 0.0))
        self.t_s += duration_s


def plan_drive(
    draws: Draws, seed: Seed, road: RoadPlan, *, cruise_m_s: float, run_up_m: float, length_m: float
) -> DrivePlan:
    """Return the drive of a world along its road; the arguments are those of `plan_road`."""
    events = [_event(draws, slot) for slot in range(EVENTS)]
    grid = plan_speed(draws, seed, road, cruise_m_s=cruise_m_s, length_m=length_m)
    return _driven(draws, grid, events, run_up_m)


def _event(draws: Draws, slot: int) -> _Event:
    kind = draws.word("driver.event", slot)
    hard = kind == "brake"
    eased_m_s2, hard_m_s2 = draws.number("driver.stop_m_s2", slot), draws.number("driver.brake_m_s2", slot)
    share = draws.number("driver.slowed_share", slot)
    lane_m, swerve_m = draws.number("driver.lane_m", slot), draws.number("driver.swerve_m", slot)
    calm_m_s2, quick_m_s2 = draws.number("driver.lane_change_m_s2", slot), draws.number("driver.swerve_m_s2", slot)
    to_left = 1.0 if draws.yes("driver.to_left", slot) else -1.0
    brakes_to_stop = draws.yes("driver.brakes_to_stop", slot)
    stops = kind == "stop" or (hard and brakes_to_stop)
    swerves = kind == "swerve"
    standing_s = draws.number("driver.standing_s", slot)
    return _Event(
        kind=kind,
        gap_s=draws.number("driver.event_gap_s", slot),
        deceleration_m_s2=hard_m_s2 if hard else eased_m_s2,
        speed_share=0.0 if stops else share,
        standing_s=standing_s,
        offset_m=to_left * (swerve_m if swerves else lane_m),
        lateral_m_s2=quick_m_s2 if swerves else calm_m_s2,
    )


def _driven(draws: Draws, grid: Grid, events: Sequence[_Event], run_up_m: float) -> DrivePlan:
    """Return the drive on the grid with the events."""
    drive, counts = _Drive(), dict.fromkeys(("stop", "slow", "brake", "lane_change", "swerve"), 0)
    shifts: list[Shift] = []
    passes_s, first_s, next_s = 0.0, None, math.inf
    waiting = list(events)
    last = len(grid.caps_m_s) - 1
    while drive.t_s < DRIVE_S and drive.place < last:
        if math.isinf(next_s) and waiting and drive.place * grid.step_m >= run_up_m:
            passes_s = drive.t_s
            next_s = drive.t_s + waiting[0].gap_s
        if drive.t_s < next_s:
            _follow(drive, grid)
            continue
        event = waiting.pop(0)
        if _happens(event, drive, grid, shifts):
            counts[event.kind] += 1
            first_s = next_s if first_s is None else first_s
        next_s = drive.t_s + waiting[0].gap_s if waiting else 2.0 * DRIVE_S
    slowing_m_s2 = draws.number("driver.deceleration_m_s2")
    legs = [*_merged(drive.cells), (drive.speed_m_s / slowing_m_s2, -slowing_m_s2)]
    return DrivePlan(legs=legs, shifts=shifts, counts=counts, passes_s=passes_s, first_event_s=first_s)


def _follow(drive: _Drive, grid: Grid, cap_m_s: float = math.inf) -> None:
    """Drive one cell as planned, speeding up where there is room."""
    faster = math.sqrt(drive.speed_m_s**2 + 2.0 * grid.speeding_m_s2 * grid.step_m)
    drive.go(grid.step_m, min(grid.caps_m_s[drive.place + 1], faster, max(cap_m_s, _CRAWL_M_S)))


def _happens(event: _Event, drive: _Drive, grid: Grid, shifts: list[Shift]) -> bool:
    """Let an event happen now; return whether it could."""
    match event.kind:
        case "lane_change" | "swerve":
            return _shift(event, drive, grid, shifts)
        case "stop" | "slow" | "brake":
            _brake(event, drive, grid)
            return True
    raise ValueError(f"no event is called '{event.kind}'")


def _brake(event: _Event, drive: _Drive, grid: Grid) -> None:
    """Brake to the event's share of the speed, and stand or keep it for its time."""
    target_m_s = event.speed_share * drive.speed_m_s
    last = len(grid.caps_m_s) - 1
    while drive.speed_m_s > target_m_s and drive.place < last:
        across_m_s2 = grid.curvatures_per_m[drive.place] * drive.speed_m_s**2
        braking_m_s2 = min(event.deceleration_m_s2, math.sqrt((_GRIP_USED_MAX * grid.grip_m_s2) ** 2 - across_m_s2**2))
        slower = math.sqrt(max(target_m_s**2, drive.speed_m_s**2 - 2.0 * braking_m_s2 * grid.step_m))
        drive.go(grid.step_m, min(grid.caps_m_s[drive.place + 1], slower))
    if target_m_s == 0.0:
        drive.stand(event.standing_s)
        return
    until_s = drive.t_s + event.standing_s
    while drive.t_s < until_s and drive.place < last:
        _follow(drive, grid, target_m_s)


def _shift(event: _Event, drive: _Drive, grid: Grid, shifts: list[Shift]) -> bool:
    """Plan a lane change, or a swerve there and back, on the next long enough straight; return whether there is one."""
    here_m = drive.place * grid.step_m + grid.step_m
    free_m = max([here_m, *(place_m + length_m for place_m, length_m, _ in shifts)])
    parts = 2 if event.kind == "swerve" else 1
    first = math.ceil(free_m / grid.step_m)
    for start in range(first, first + int(_AHEAD_MAX_M / grid.step_m)):
        if start >= len(grid.caps_m_s):
            return False
        # as long as the speed at its beginning needs, unless the vehicle may be faster on the way
        length_m = _shift_length_m(event, grid, grid.caps_m_s[start])
        cells = math.ceil(parts * length_m / grid.step_m) + 1
        if start + cells >= len(grid.caps_m_s):
            return False
        length_m = _shift_length_m(event, grid, max(grid.caps_m_s[start : start + cells]))
        cells = math.ceil(parts * length_m / grid.step_m) + 1
        speed_m_s = max(grid.caps_m_s[start : start + cells])
        is_straight = max(grid.curvatures_per_m[start : start + cells]) <= _STRAIGHT_PER_M
        if not is_straight or _shift_length_m(event, grid, speed_m_s) > length_m:
            continue
        offsets_m = (event.offset_m, -event.offset_m)[:parts]
        shifts.extend(
            (start * grid.step_m + part * length_m, length_m, offset_m) for part, offset_m in enumerate(offsets_m)
        )
        curvature_per_m = SHIFT_CURVATURE * abs(event.offset_m) / length_m**2
        grid.curvatures_per_m[start : start + cells] = [curvature_per_m] * cells
        return True
    return False


def _shift_length_m(event: _Event, grid: Grid, speed_m_s: float) -> float:
    """Return the length of a shift at a speed: what grip, the tightest turn and the driver's hands ask for."""
    lateral_m_s2, offset_m = min(event.lateral_m_s2, _GRIP_SHIFT_MAX * grid.grip_m_s2), abs(event.offset_m)
    return max(
        speed_m_s * math.sqrt(SHIFT_CURVATURE * offset_m / lateral_m_s2),
        math.sqrt(SHIFT_CURVATURE * offset_m * TURN_RADIUS_MIN_M),
        math.cbrt(4.0 * SHIFT_CURVATURE * offset_m * speed_m_s / STEERING_MAX_PER_M_S),
    )


def _merged(cells: Sequence[tuple[float, float, float]]) -> list[Leg]:
    """Return the cells as legs, neighbours of equal acceleration as one."""
    legs: list[tuple[float, float, float]] = []
    for duration_s, before_m_s, after_m_s in cells:
        if legs:
            long_s, first_m_s, last_m_s = legs[-1]
            same = (last_m_s - first_m_s) / long_s - (after_m_s - before_m_s) / duration_s
            if abs(same) < _SAME_M_S2:
                legs[-1] = (long_s + duration_s, first_m_s, after_m_s)
                continue
        legs.append((duration_s, before_m_s, after_m_s))
    return [(duration_s, (after - before) / duration_s) for duration_s, before, after in legs if duration_s > 0.0]
