"""A drone that a vehicle is about to be under is raised over it, and no other is."""

import math

import numpy as np
import pytest

from companion.core.data import Array
from companion.landing.sortie.aims import sortie_aim
from companion.landing.sortie.over_vehicle import keep_out_now
from companion.landing.sortie.rise_over_vehicle import rise_over_vehicle
from companion.landing.state.memory import ModelMemory, Places, StepMemory
from companion.landing.steering.flown_plan import FlownPlan
from companion.landing.steering.targets import HORIZON_OFFSETS_S, Aim
from companion.planning.guidance import ReferenceState, Target, Trajectory
from companion.situation.phases import Phase
from companion.situation.situation import Drone
from companion.sortie.memory import SortieMemory, Way
from companion.vehicle.pad import PadPath
from link.messages import Station, Vector3
from link.records import replace
from tests.companion.facts import CONFIG, GEAR_M, NOW_NS, progress, situation

ROOF_M = 2.6  # as a van's: the lowest station beside it is lower
PAD = PadPath(
    offset_s=HORIZON_OFFSETS_S,
    position_enu_m=np.array([2.0, -1.0, ROOF_M]) + HORIZON_OFFSETS_S[:, None] * np.array([4.0, 0.0, 0.0]),
    velocity_enu_m_s=np.tile([4.0, 0.0, 0.0], (len(HORIZON_OFFSETS_S), 1)),
    acceleration_enu_m_s2=np.zeros((len(HORIZON_OFFSETS_S), 3)),
    yaw_rad=0.0,
    position_std_m=np.full((len(HORIZON_OFFSETS_S), 3), 0.05),
    half_width_m=0.75,
    height_m=ROOF_M,
)
KEEP_OUT = keep_out_now(PAD, CONFIG)
LOW_M = -0.5  # of the feet from the roof
LIMITS = CONFIG.limits.flight_limits()


def place(ahead_m: float, left_m: float, up_m: float = LOW_M) -> Array:
    return np.asarray(PAD.position_enu_m[0] + np.array([ahead_m, left_m, up_m + GEAR_M]))


def drone(position_enu_m: Array, velocity_enu_m_s: Vector3) -> Drone:
    return Drone(position_enu_m=position_enu_m, velocity_enu_m_s=np.array(velocity_enu_m_s), yaw_rad=0.0, age_s=0.02)


def plan(start_enu_m: Array, velocity_enu_m_s: Vector3) -> FlownPlan:
    """A plan that goes on evenly."""
    velocity = np.tile(velocity_enu_m_s, (len(HORIZON_OFFSETS_S), 1))
    trajectory = Trajectory(
        offset_s=HORIZON_OFFSETS_S,
        position_enu_m=start_enu_m + velocity * HORIZON_OFFSETS_S[:, None],
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=np.zeros_like(velocity),
    )
    return FlownPlan(starts_ns=NOW_NS, trajectory=trajectory, lowest_enu_m=0.0, shaping=None, limits=LIMITS)


def aim_at(up_m: float) -> Aim:
    position = PAD.position_enu_m + np.array([8.0, 0.0, up_m + GEAR_M])
    target = Target(
        offset_s=PAD.offset_s,
        position_enu_m=position,
        velocity_enu_m_s=PAD.velocity_enu_m_s,
        acceleration_enu_m_s2=PAD.acceleration_enu_m_s2,
    )
    return Aim(target=target, floor_enu_m=position[:, 2] - 0.5)


def raised(flown: FlownPlan | None, now: Drone | None, up_m: float = LOW_M) -> Array:
    """Return how much higher (n, 2) target and floor are."""
    aim = aim_at(up_m)
    higher = rise_over_vehicle(aim, flown, now, PAD, KEEP_OUT, monotonic_ns=NOW_NS, feet_offset_m=GEAR_M, config=CONFIG)
    target = higher.target.position_enu_m[:, 2] - aim.target.position_enu_m[:, 2]
    return np.column_stack((target, higher.floor_enu_m - aim.floor_enu_m))


def test_plan_that_the_vehicle_will_drive_under_is_raised_over_the_roof_when_it_does() -> None:
    ahead_m = KEEP_OUT.radius_m + 5.0
    rises = raised(plan(place(ahead_m, 0.7), (0.0, 0.0, 0.0)), None)
    distance_m = np.hypot(ahead_m - 4.0 * HORIZON_OFFSETS_S, 0.7)
    deep = distance_m < KEEP_OUT.radius_m - CONFIG.sortie.keep_out_margin_m
    assert deep.any()
    assert rises[deep] == pytest.approx(np.tile(KEEP_OUT.over_m - np.array([LOW_M, LOW_M - 0.5]), (deep.sum(), 1)))
    assert not rises[distance_m >= KEEP_OUT.radius_m].any()


def test_nothing_is_raised_beside_the_vehicle_or_clear_of_its_roof() -> None:
    beside = place(1.0, KEEP_OUT.radius_m + 0.1)
    along = (4.0, 0.0, 0.0)
    assert not raised(plan(beside, along), drone(beside, along)).any()
    above = raised(plan(place(0.3, 0.0, 4.0), along), None, up_m=KEEP_OUT.over_m + 0.6)
    assert not above.any()


def test_drone_that_drifts_towards_the_vehicle_against_its_plan_is_raised_for_as_long_as_that_tells() -> None:
    beside = place(1.0, KEEP_OUT.radius_m + 0.5)
    rises = raised(plan(beside, (4.0, 0.0, 0.0)), drone(beside, (4.0, -2.0, 0.0)))
    assert rises[(HORIZON_OFFSETS_S > 0.5) & (HORIZON_OFFSETS_S <= 1.0)].all()
    assert not rises[HORIZON_OFFSETS_S > 1.0].any()


@pytest.mark.parametrize("inside_m", [0.1, 0.2, 0.35])
def test_rise_grows_with_the_part_of_the_margin_that_is_lost(inside_m: float) -> None:
    beside = place(0.0, KEEP_OUT.radius_m - inside_m)
    target, _ = raised(plan(beside, (4.0, 0.0, 0.0)), None)[7].tolist()
    assert target == pytest.approx((KEEP_OUT.over_m - LOW_M) * inside_m / (0.5 * CONFIG.sortie.keep_out_margin_m))


@pytest.mark.parametrize("phase", [Phase.FOLLOW, Phase.RETURN, Phase.ABORT])
def test_every_phase_beside_the_vehicle_raises_its_aim(phase: Phase) -> None:
    here, station = place(KEEP_OUT.radius_m + 3.0, 0.4), Station(offset_m=(7.0, 0.4, LOW_M))
    at_station = np.array(station.offset_m)
    memory = StepMemory(
        progress=progress(phase),
        model=ModelMemory(
            reference=ReferenceState(
                position_enu_m=here, velocity_enu_m_s=np.zeros(3), acceleration_enu_m_s2=np.zeros(3)
            ),
            plan=plan(here, (0.0, 0.0, 0.0)),
        ),
        places=Places(anchor_enu_m=here),
        sortie=SortieMemory(
            station=station,
            way=Way(station=station, frame=station.frame, end_m=at_station, place_m=at_station, at_ns=NOW_NS),
        ),
    )
    facts = replace(situation(pad=PAD), drone=drone(here, (0.0, 0.0, 0.0)))
    aim = sortie_aim(memory, facts, LIMITS, CONFIG)
    assert aim is not None
    under = np.hypot(*(here - PAD.position_enu_m)[:, :2].T) < KEEP_OUT.radius_m - CONFIG.sortie.keep_out_margin_m
    clear_enu_m = PAD.position_enu_m[:, 2] + GEAR_M + CONFIG.descent.alignment.height_m
    assert under.any()
    assert np.all(aim.floor_enu_m[under] >= clear_enu_m[under] - 1e-9)
    assert math.isfinite(float(aim.target.position_enu_m.sum()))
