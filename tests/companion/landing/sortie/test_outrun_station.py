"""A station that a turning vehicle swings round faster than the drone can fly is flown to without turning along."""

import math

import numpy as np
import pytest

from companion.core.data import Array
from companion.core.reasons import Reason
from companion.landing.outputs import landing_status
from companion.landing.sortie.aims import advance_way, station_aim
from companion.landing.sortie.over_vehicle import WAY_SHARE, turns_too_fast
from companion.landing.state.memory import ModelMemory, StepMemory
from companion.landing.steering.targets import HORIZON_OFFSETS_S
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Phase
from companion.sortie.memory import SortieMemory
from companion.vehicle.pad import PadPath
from link.messages import Station, StationFrame, Vector3
from link.records import replace
from tests.companion.facts import CONFIG, GEAR_M, TICK_NS, at_time, progress, situation

SPEED_M_S, RATE_RAD_S = 8.0, 0.4  # on a circle of 20 m
LIMITS = replace(CONFIG.limits.flight_limits(), speed_max_m_s=30.0, acceleration_max_m_s2=5.0)
FAR, NEAR = Station(offset_m=(-40.0, 0.0, 3.0)), Station(offset_m=(-6.0, 1.0, 3.0))


def pad_after(t_s: float) -> PadPath:
    """A pad that has driven on a circle about the origin for some time."""
    angle = 0.3 + RATE_RAD_S * (t_s + HORIZON_OFFSETS_S)
    radius_m, rates = SPEED_M_S / RATE_RAD_S, np.full_like(HORIZON_OFFSETS_S, RATE_RAD_S)
    level = np.zeros_like(angle)
    out = np.column_stack((np.cos(angle), np.sin(angle), level))
    along = np.column_stack((-np.sin(angle), np.cos(angle), level))
    return PadPath(
        offset_s=HORIZON_OFFSETS_S,
        position_enu_m=radius_m * out + np.array([0.0, 0.0, 1.5]),
        velocity_enu_m_s=SPEED_M_S * along,
        acceleration_enu_m_s2=-SPEED_M_S * RATE_RAD_S * out,
        yaw_rad=float(angle[0]) + 0.5 * math.pi,
        position_std_m=np.full((len(angle), 3), 0.05),
        yaw_rate_rad_s=rates,
        half_width_m=0.75,
        height_m=1.5,
    )


def flown(station: Station, starts_enu_m: Vector3, duration_s: float) -> tuple[StepMemory, list[Array]]:
    """Return the memory and the offsets in W of a drone that is where its aim has it, or as near as it can be."""
    feet_m = np.array([0.0, 0.0, GEAR_M])
    here = pad_after(0.0).position_enu_m[0] + np.array(starts_enu_m) + feet_m
    memory = StepMemory(progress=progress(Phase.FOLLOW), sortie=SortieMemory(is_out=True, station=station))
    offsets, velocity = [], np.zeros(3)
    for k in range(round(duration_s / (TICK_NS * 1e-9))):
        t_s = k * TICK_NS * 1e-9
        pad = pad_after(t_s)
        reference = ReferenceState(position_enu_m=here, velocity_enu_m_s=velocity, acceleration_enu_m_s2=np.zeros(3))
        facts = situation(pad=pad)
        facts = at_time(facts, facts.monotonic_ns + k * TICK_NS)
        memory = advance_way(replace(memory, model=ModelMemory(reference=reference)), facts, LIMITS, CONFIG)
        place = station_aim(memory.sortie, pad, facts, LIMITS, CONFIG).target.position_enu_m[0]
        offsets.append(place - pad.position_enu_m[0] - feet_m)
        step_max_m = LIMITS.speed_max_m_s * TICK_NS * 1e-9
        way = place - here
        here = here + way * min(1.0, step_max_m / max(float(np.linalg.norm(way)), 1e-9))
    return memory, offsets


@pytest.mark.parametrize(("station", "is_outrun"), [(FAR, True), (NEAR, False)])
def test_place_far_from_a_vehicle_on_a_tight_circle_turns_too_fast(station: Station, *, is_outrun: bool) -> None:
    pad = pad_after(0.0)
    assert pad.yaw_rad is not None
    arm = np.array(station.offset_m)
    assert turns_too_fast(arm, StationFrame.VEHICLE, pad.yaw_rad, pad, LIMITS) is is_outrun
    assert not turns_too_fast(arm, StationFrame.NORTH, 0.5 * math.pi, pad, LIMITS)
    outside = replace(LIMITS, acceleration_max_m_s2=1e3, speed_max_m_s=17.0)
    # 20 m to the centre and 40 m behind: 0.4 rad/s swing that at 17.9 m/s
    assert turns_too_fast(arm, StationFrame.VEHICLE, pad.yaw_rad, pad, outside) is is_outrun


def test_place_on_the_way_to_a_far_station_is_not_swung_round_and_stays_within_its_distance() -> None:
    memory, offsets = flown(FAR, (3.0, 1.0, 3.0), 30.0)
    assert memory.sortie.way is not None
    assert memory.sortie.way.frame is StationFrame.NORTH
    moved_m_s = np.linalg.norm(np.diff(offsets, axis=0), axis=1) / (TICK_NS * 1e-9)
    assert moved_m_s.max() < math.sqrt(2.0 * WAY_SHARE * LIMITS.acceleration_max_m_s2 * 80.0)  # and no 17.9 m/s
    assert max(float(np.hypot(*one[:2])) for one in offsets) <= 40.0 + 1e-6


def test_drone_far_from_a_vehicle_on_a_tight_circle_comes_to_a_near_station() -> None:
    memory, offsets = flown(NEAR, (-45.0, 30.0, 3.0), 40.0)
    assert memory.sortie.way is not None
    assert memory.sortie.way.frame is StationFrame.VEHICLE
    assert float(np.hypot(*offsets[-1][:2])) == pytest.approx(math.hypot(6.0, 1.0), abs=0.01)


@pytest.mark.parametrize(("station", "is_outrun"), [(FAR, True), (NEAR, False)])
def test_status_says_that_the_station_turns_too_fast_and_where_it_is(station: Station, *, is_outrun: bool) -> None:
    memory, _ = flown(station, (-6.0, 4.0, 3.0), 1.0)
    status = landing_status(memory, situation(pad=pad_after(1.0)), CONFIG)
    assert status.station_offset_m == pytest.approx(station.offset_m)
    assert (status.reason_code == Reason.STATION_OUTRUNS.name) is is_outrun
