"""Whether two receivers place things in one frame; pure.

Each receiver states its error within its own frame. How far these are apart neither states: centimetres where both are
corrected by one base station or network, and metres without corrections. Phases that are fixed on both are taken for
corrections of one source, for that is how they are flown; who has two base stations says so (`receiver_frames`).
Otherwise only sightings of the pad tell the offset, which the estimate has as unknown until then. That is so as well
while the drone's receiver has no fix, whoever says what: its autopilot goes on by dead reckoning then.

A fixed carrier phase errs by a quarter of its wavelength at most, which is what reflections do to it
(Hofmann-Wellenhof, Lichtenegger and Collins, "GPS: Theory and Practice", 5th edition, multipath): who states more has
not fixed it. One that steps by more than two such errors has been fixed wrongly, before or after, and one that slides
away from what its velocities tell is led astray (`slide`). Until it has been fixed anew nobody knows where it is. The
drone's has stepped by what its place has and its local frame has not.
"""

import math
from collections.abc import Sequence

from msgspec import Struct

from companion.autopilots.driver import Receiver
from companion.autopilots.frame_moves import NO_MOVES, FrameMoves, stepped_in_frame_m
from companion.config.companion import CompanionConfig
from companion.config.integrity import ReceiverFrames
from companion.core.data import FIXED_STD_MAX_M, Measurement, Quantity
from companion.core.reasons import Cause, Reason
from companion.integrity.way import WayError
from companion.situation.situation import Situation
from link.records import replace

_HOLD_S = 2.0  # two of the autopilot's reports of its receiver


class FixedPhases(Struct, frozen=True, kw_only=True):
    """What both receivers say of their phases, and the drone's of its fix.

    Attributes:
        vehicle_std_m: that the newest fix of the vehicle states horizontally, None before the first.
        since_ns: monotonic, since when both have had fixed phases without a break; None while one has not.
        steps: of the vehicle's place, when they were last counted.
        has_vehicle_stepped: by more than fixed phases err, while both had them, or slid.
        stamps_off_s: by how much its stamps have stepped since, as its places tell; 0 once they have gone back.
        fixed_moves: of the drone's place and of its local frame, when both had fixed phases first.
        has_drone_stepped: since then, by more than fixed phases err.
        unfixed_ns: monotonic, when the drone's receiver was without a fix last; None while it never was.
    """

    vehicle_std_m: float | None = None
    since_ns: int | None = None
    steps: int = 0
    has_vehicle_stepped: bool = False
    stamps_off_s: float = 0.0
    fixed_moves: FrameMoves = NO_MOVES
    has_drone_stepped: bool = False
    unfixed_ns: int | None = None

    @property
    def has_stepped(self) -> bool:
        """Whether one of them has, and has not been fixed anew."""
        return self.has_vehicle_stepped or self.has_drone_stepped or self.stamps_off_s != 0.0


def update_fixed_phases(
    before: FixedPhases,
    measurements: Sequence[Measurement],
    monotonic_ns: int,
    *,
    drone: Receiver,
    moves: FrameMoves,
) -> FixedPhases:
    """Return what both receivers say by now.

    A receiver that is fixed anew says nothing of the other, which has stepped.

    Args:
        before: by the step before.
        measurements: of the vehicle since then.
        monotonic_ns: now.
        drone: what its receiver says, as the autopilot tells.
        moves: of the drone's place and of its local frame.
    """
    fixes = [one for one in measurements if one.quantity is Quantity.POSITION]
    std_m = before.vehicle_std_m
    if fixes:
        newest = max(fixes, key=lambda fix: fix.t_ns)
        std_m = max(newest.covariance.diagonal().tolist()[:2]) ** 0.5
    vehicle_is_fixed = std_m is not None and std_m <= FIXED_STD_MAX_M
    are_both = vehicle_is_fixed and drone.is_fixed
    is_compared = drone.is_fixed and (before.since_ns is not None or before.has_drone_stepped)
    fixed_moves = before.fixed_moves if is_compared else moves
    return FixedPhases(
        vehicle_std_m=std_m,
        since_ns=(monotonic_ns if before.since_ns is None else before.since_ns) if are_both else None,
        steps=before.steps,
        has_vehicle_stepped=before.has_vehicle_stepped and vehicle_is_fixed,
        stamps_off_s=before.stamps_off_s if vehicle_is_fixed else 0.0,
        fixed_moves=fixed_moves,
        has_drone_stepped=_has_drone_stepped(fixed_moves, moves),
        unfixed_ns=monotonic_ns if drone.has_fix is False else before.unfixed_ns,
    )


def _has_drone_stepped(fixed: FrameMoves, now: FrameMoves) -> bool:
    """Return whether the drone's place has stepped by more than fixed phases err and a step is unsure.

    The sum counts: a place that steps back is where it was, and of an origin that moves the place tells before it does.
    """
    if now is fixed:
        return False
    (east_m, north_m), (fixed_east_m, fixed_north_m) = stepped_in_frame_m(now), stepped_in_frame_m(fixed)
    # An autopilot that restarts counts anew.
    unsure_m = 2.0 * math.sqrt(max(now.shift_variance_m2 - fixed.shift_variance_m2, 0.0))
    return math.hypot(east_m - fixed_east_m, north_m - fixed_north_m) > 2.0 * FIXED_STD_MAX_M + unsure_m


def with_place_step(
    before: FixedPhases, place_step: tuple[int, float], of_stamps: WayError | None = None
) -> FixedPhases:
    """Return what both receivers say, and whether the vehicle's place has stepped.

    Stamps that step move it along its way, and back once they are what they were: the sum counts.

    Args:
        before: by the step before.
        place_step: as `BufferHealth` has it.
        of_stamps: how the fix differs from what was expected, if its stamp has stepped; None if its place has.
    """
    count, moved_m = place_step
    has_stepped = count > before.steps and before.since_ns is not None and moved_m > 2.0 * FIXED_STD_MAX_M
    if of_stamps is None or not (has_stepped or before.stamps_off_s):
        has_vehicle_stepped = before.has_vehicle_stepped or has_stepped
        return (
            before if count == before.steps else replace(before, steps=count, has_vehicle_stepped=has_vehicle_stepped)
        )
    off_s = before.stamps_off_s + of_stamps.ahead_s
    is_back = before.stamps_off_s != 0.0 and abs(off_s) * of_stamps.speed_m_s <= 4.0 * FIXED_STD_MAX_M
    return replace(before, steps=count, stamps_off_s=0.0 if is_back else off_s)


def with_slide(before: FixedPhases) -> FixedPhases:
    """Return what both receivers say once the vehicle's places have slid away from what its velocities tell."""
    return replace(before, has_vehicle_stepped=True)


def without_place_step(before: FixedPhases) -> FixedPhases:
    """Return what both receivers say where the steps so far were those of an estimate that was led astray."""
    return replace(before, has_vehicle_stepped=False, stamps_off_s=0.0)


def has_lost_fix(before: FixedPhases, drone: Receiver, monotonic_ns: int) -> bool:
    """Return whether the drone's receiver is without a fix since now; a short one in between is none.

    Args:
        before: by the step before.
        drone: what its receiver says.
        monotonic_ns: now.
    """
    return drone.has_fix is False and not _was_unfixed(before, monotonic_ns)


def are_frames_one(phases: FixedPhases, configured: ReceiverFrames, monotonic_ns: int) -> bool:
    """Return whether both receivers' positions can be compared without a sighting."""
    match configured:
        case ReceiverFrames.ONE:
            return not (_was_unfixed(phases, monotonic_ns) or phases.has_stepped)
        case ReceiverFrames.APART:
            return False
        case ReceiverFrames.AUTO:
            if phases.since_ns is None or phases.has_stepped:
                return False
            return _is_held(phases.since_ns, monotonic_ns)


_FRAME_REMEDIES = {
    ReceiverFrames.AUTO: "use a pattern detector, RTK on both from one source, or --receiver-frames one where they are "
    "known to have one",
    ReceiverFrames.ONE: "the drone's has lost its fix: wait until it has one again, or use a pattern detector",
    ReceiverFrames.APART: "use a pattern detector, or RTK on both from one source and --receiver-frames auto",
}
_STEPPED_REMEDY = (
    "the place of one has stepped, or changes otherwise than its velocities say: wait until its phases are fixed anew, "
    "or use a pattern detector"
)


def tell_unseen(s: Situation, config: CompanionConfig) -> Cause:
    """Return why a pad that has to be seen is not, or not well enough, with what helps beside what is set already."""
    if s.vehicle.has_unplaced_sightings:
        return Cause(Reason.SIGHTINGS_UNPLACED)
    if s.vehicle.is_pad_sighted:
        return Cause(Reason.SIGHTINGS_VAGUE)
    if config.silent_vehicle is not None:
        return Cause(Reason.PAD_NOT_SEEN)
    configured = config.integrity.receiver_frames
    has_stepped = s.vehicle.has_receiver_stepped and configured is not ReceiverFrames.APART
    return Cause(Reason.OFFSET_UNKNOWN, (_STEPPED_REMEDY if has_stepped else _FRAME_REMEDIES[configured],))


def tell_unheard(s: Situation, config: CompanionConfig) -> Cause:
    """Return why nothing is known of the vehicle now: of one that tells nothing, why it is not seen."""
    return Cause(Reason.NO_VEHICLE_DATA) if config.silent_vehicle is None else tell_unseen(s, config)


def tell_uncertain(s: Situation, config: CompanionConfig) -> Cause:
    """Return why the pad's place is uncertain: of a vehicle that tells nothing, why it is not seen."""
    return Cause(Reason.VEHICLE_UNCERTAIN) if config.silent_vehicle is None else tell_unseen(s, config)


def _was_unfixed(phases: FixedPhases, monotonic_ns: int) -> bool:
    """Return whether the drone's receiver was without a fix lately."""
    return phases.unfixed_ns is not None and not _is_held(phases.unfixed_ns, monotonic_ns)


def _is_held(since_ns: int, monotonic_ns: int) -> bool:
    return (monotonic_ns - since_ns) * 1e-9 >= _HOLD_S
