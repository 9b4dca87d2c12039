"""What makes each test of the phases true, everything else being in order."""

import numpy as np

from companion.core.data import GRAVITY_M_S2, Rival
from companion.core.reasons import Reason
from companion.situation.situation import Following, Situation
from companion.vehicle.pad import FrameOffset
from companion.vehicle.pad_reach import cone_radius_m
from link.records import replace
from tests.companion.facts import (
    CONFIG,
    braking_pad,
    changed,
    drone_at,
    forecast_of,
    pad_at,
    reference_at,
    situation,
)

HALF_M = pad_at().half_width_m
OVER_PAD_M = 2.0 * CONFIG.descent.cone.radius_at_pad_m
HIGH_M = CONFIG.descent.alignment.height_m
NEAR_M = 0.9 * CONFIG.abort.near_height_m
LOW_M = 0.5 * CONFIG.descent.commit_height_m

LIMITS = CONFIG.limits.flight_limits()


def risky(height_m: float, sinks_m_s: float = 0.0, unsafe: float = 0.9, broken_off: float = 0.0) -> Situation:
    """The same over the pad with a forecast that a contact would be unsafe, or is broken off."""
    drone = drone_at(height_m, 0.0, (0.0, 0.0, -sinks_m_s), pad=pad_at())
    return changed(situation(height_m), drone=drone, limits=LIMITS, contact=forecast_of(unsafe, broken_off=broken_off))


def jolted(facts: Situation) -> Situation:
    """The same with a drone whose velocity has just changed faster than flying can."""
    assert facts.drone is not None
    return replace(facts, drone=replace(facts.drone, jolt_m_s2=CONFIG.touchdown.jolt_m_s2 + 0.1))


# What makes each abort test true, everything else being in order; in the descent, above the commit height but for one.
UNSAFE: dict[Reason, Situation] = {
    Reason.VEHICLE_DATA_OLD: changed(situation(), fix_age_s=CONFIG.abort.fix_age_max_s + 0.01),
    Reason.VEHICLE_UNCERTAIN: situation(pad=pad_at(std_m=CONFIG.abort.position_std_max_m + 0.01)),
    Reason.OFFSET_UNKNOWN: situation(pad=replace(pad_at(std_m=1.0), has_one_frame=False)),
    Reason.VEHICLE_LINK_LOST: changed(
        situation(), is_alive=False, fix_age_s=CONFIG.abort.alive_lost_fix_age_max_s + 0.01
    ),
    Reason.VEHICLE_CLOCK_AHEAD: changed(situation(), fix_age_on_arrival_s=-CONFIG.integrity.fix_ahead_max_s - 0.01),
    Reason.STAMPS_STEPPED: changed(
        situation(pad=replace(pad_at((4.0, 1.0, 0.0)), frame_offset=FrameOffset(is_confirmed=False))),
        stamps_stepped_s=0.3,
    ),
    Reason.OWN_POSITION_OLD: replace(situation(), drone=None),
    Reason.OWN_ATTITUDE_OLD: replace(situation(), drone=replace(drone_at(1.5, pad=pad_at()), attitude_known=False)),
    Reason.HEADING_UNKNOWN: situation(pad=pad_at((0.0, 0.0, 0.0), placed=False)),
    Reason.SETPOINT_NOT_FOLLOWED: replace(situation(), following=Following(error_m=1.01, error_max_m=1.0)),
    Reason.OUTSIDE_CONE: situation(NEAR_M, cone_radius_m(NEAR_M, HALF_M, CONFIG) + 0.01),
    Reason.TOO_FAST_NEAR_PAD: replace(
        situation(),
        drone=drone_at(NEAR_M, 0.0, (CONFIG.abort.near_speed_max_m_s + 0.01, 0.0, 0.0), pad=pad_at()),
    ),
    Reason.WOULD_BLOW_OFF: changed(
        situation(CONFIG.descent.wait.height_m), pushed_m_s2=CONFIG.touchdown.gear_friction * GRAVITY_M_S2
    ),
    Reason.CONTACT_RISKY: risky(LOW_M),
    Reason.TOO_FAR_FROM_START: replace(
        situation(), waiting_point_enu_m=np.array([CONFIG.limits.range_max_m + 10.0, 0.0, 5.0])
    ),
    Reason.VEHICLE_OUTRUNS: replace(situation(), limits=replace(CONFIG.limits.flight_limits(), speed_max_m_s=4.1)),
    Reason.VEHICLE_CONTRADICTS_ITSELF: changed(situation(), rejected_share=CONFIG.integrity.rejected_share_max + 0.01),
    Reason.SEEN_ELSEWHERE: situation(pad=replace(pad_at(), frame_offset=FrameOffset(distance_m=1.0, std_m=0.01))),
    Reason.VEHICLE_TAKEN: changed(situation(), rival=Rival(drone="drone2", is_this_drone=False)),
    Reason.PAD_CHANGED: changed(situation(), is_pad_doubted=True),
    Reason.SIGHTINGS_DISAGREE: changed(situation(), are_sightings_mixed=True),
    Reason.SIGHTINGS_IMPOSSIBLE: situation(
        pad=replace(
            braking_pad(CONFIG.integrity.acceleration_max_m_s2 + 0.1),
            is_coarse=True,
            frame_offset=FrameOffset(distance_m=0.0, std_m=0.1),
        )
    ),
    Reason.SEEN_TOO_NEAR: changed(situation(), range_height_m=0.5),
    Reason.BELOW_PAD: situation(-CONFIG.descent.sink.press_depth_m - CONFIG.touchdown.height_max_m - 0.01),
    Reason.ROAD_BELOW: changed(
        situation(0.0, pad=replace(pad_at(), height_m=1.5)),
        reference=reference_at(-0.5 * CONFIG.descent.sink.press_depth_m),
        range_height_m=1.5,
    ),
    Reason.SETPOINTS_UNHEARD: changed(
        situation(LOW_M),
        reference=reference_at(LOW_M - 0.3),
        range_height_m=LOW_M,
        unanswered_s=CONFIG.touchdown.range_finder.disputed_hold_s + 0.01,
    ),
    Reason.NOTHING_TOUCHED: situation(-CONFIG.touchdown.lost.missed_depth_m - 0.01),
}
# Below the commit height these still count: without them nobody knows where the pad is.
