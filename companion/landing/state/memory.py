"""The step's memory, in groups that are reset together, and how it moves with the frame; pure.

Spans of time are measured on the step's monotonic clock, which nobody sets; whatever is compared with a stamp of the
vehicle's data is in UTC.
"""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from msgspec import Struct, field

from companion.autopilots.driver import AutopilotView, DriverMemory
from companion.autopilots.frame_moves import NO_MOVES, FrameMoves
from companion.core.data import Array
from companion.core.reasons import Cause, Reason
from companion.forecast.drivers import Drivers
from companion.forecast.gusts import Gusts
from companion.integrity.contradictions import Contradictions
from companion.integrity.frames import FixedPhases
from companion.integrity.sightings import SightingWatch
from companion.integrity.slide import FixSlide
from companion.integrity.stamps import FixStamps
from companion.integrity.vehicle_data import CourseWatch
from companion.landing.steering.flown_plan import FlownPlan
from companion.landing.steering.virtual_model import NO_RIDE, Ride, Tracking, move_tracking
from companion.planning.guidance import GuidanceMemory, ReferenceState
from companion.situation.phases import Phase
from companion.sortie.memory import SortieMemory, move_sortie
from companion.vehicle.crest import Crest
from companion.vehicle.estimator import EstimatorMemory
from companion.vehicle.hindsight import Hindsight
from companion.vehicle.range_watch import RangeWatch
from companion.vehicle.velocity_lag import VelocityLag
from companion.vehicle.velocity_point import VelocityPoint
from link.messages import ContactForecast, Vector3
from link.records import replace

Held = Mapping[Reason, int]
"""Since when (monotonic ns) each condition has been true, by its reason."""

NOTHING_HELD: Held = MappingProxyType({})


class Progress(Struct, frozen=True, kw_only=True, eq=False):
    """Where in the landing we are, for how long, and what is counted over it.

    Attributes:
        phase: of the landing.
        since_ns: when it began, monotonic; a chase that goes on after an outage, when it began first.
        cause: why it began.
        retries: landings aborted since the start.
        interrupted_ns: when the chase began that an outage has broken off; None when an abort counts.
        begun_anew: how often this approach has been aligned or chased again, by the reason.
        waits_since_ns: when it began to wait for a smaller risk; None while it does not.
        waited_s: for how long it has done so before, in this phase.
        may_retry: no operator has broken the landing off since the start.
        stopped_by_pad: the contact was a jolt.
        held: since when each condition of the phase has been true.
        obstacle: what makes a landing impossible, as it was first told; None without one.
    """

    phase: Phase = Phase.IDLE
    since_ns: int = 0
    cause: Cause = field(default_factory=lambda: Cause(Reason.WAITING_FOR_START))
    retries: int = 0
    interrupted_ns: int | None = None
    begun_anew: Mapping[Reason, int] = field(default_factory=dict)
    waits_since_ns: int | None = None
    waited_s: float = 0.0
    may_retry: bool = True
    stopped_by_pad: bool = False
    held: Held = field(default_factory=lambda: NOTHING_HELD)
    obstacle: Cause | None = None


class VehicleMemory(Struct, frozen=True, kw_only=True, eq=False):
    """What is known of the vehicle, and whether it can be believed.

    Attributes:
        estimator: the estimator's own memory.
        velocity_lag: by how much its velocities are older than its places.
        velocity_point: of which point they are.
        slide: whether its places slide away from the way that its velocities tell.
        hindsight: how the vehicle has driven, and how late that is known.
        fix_stamps: whether its fixes come from the future, and whether a clock was set.
        contradictions: of its data.
        sightings: whether they agree with each other.
        phases: whether its receiver and the drone's have fixed ones.
        course: how its heading compares with its course.
        utc_ahead_ns: of the monotonic clock, when its stamps were last compared with UTC.
        ranges: the last readings of the drone's range finder.
        is_road_elsewhere: it is said to be far above or below the ground; None before that can be judged.
        frame_moves: of the frame that the estimate and the ranges are in.
        crest: how high waves have lifted its deck.
    """

    estimator: EstimatorMemory | None = None
    velocity_lag: VelocityLag = field(default_factory=VelocityLag)
    velocity_point: VelocityPoint = field(default_factory=VelocityPoint)
    slide: FixSlide = field(default_factory=FixSlide)
    hindsight: Hindsight = field(default_factory=Hindsight)
    fix_stamps: FixStamps = field(default_factory=FixStamps)
    contradictions: Contradictions = field(default_factory=Contradictions)
    sightings: SightingWatch = field(default_factory=SightingWatch)
    phases: FixedPhases = field(default_factory=FixedPhases)
    course: CourseWatch = field(default_factory=CourseWatch)
    utc_ahead_ns: int = 0
    ranges: RangeWatch = field(default_factory=RangeWatch)
    is_road_elsewhere: bool | None = None
    frame_moves: FrameMoves = NO_MOVES
    crest: Crest = Crest()


class ModelMemory(Struct, frozen=True, kw_only=True, eq=False):
    """The virtual model that the setpoints follow, and how the drone follows it.

    Attributes:
        reference: the model, None while nothing is flown.
        reference_ns: the model's time, monotonic.
        plan: the newest, which begins when its setpoint takes effect; None once the model is set elsewhere.
        guidance: the guidance law's own memory.
        tracking: how the drone follows it.
        ride: how high it flies on its setpoints.
        yaw_setpoint_rad: last one sent.
    """

    reference: ReferenceState | None = None
    reference_ns: int = 0
    plan: FlownPlan | None = None
    guidance: GuidanceMemory | None = None
    tracking: Tracking = field(default_factory=Tracking)
    ride: Ride = NO_RIDE
    yaw_setpoint_rad: float = 0.0


class ControlMemory(Struct, frozen=True, kw_only=True, eq=False):
    """How the autopilot stands to the companion.

    Attributes:
        driver: the driver's memory.
        mode_before: of the autopilot as the flight began.
        was_in_control: the autopilot's mode has been the companion's since the start.
        was_armed: and its motors were armed in that mode.
        has_flown: it has told since the start that it is in the air.
    """

    driver: DriverMemory = field(default_factory=DriverMemory)
    mode_before: int | None = None
    was_in_control: bool = False
    was_armed: bool = False
    has_flown: bool = False


class Places(Struct, frozen=True, kw_only=True, eq=False):
    """Places in W, and which W that is.

    Attributes:
        waiting_point_enu_m: (3,) where the drone waits for the vehicle.
        anchor_enu_m: (3,) where a hover phase stays.
        ground_enu_m: (3,) of the ground.
        frame_moves: of the frame that they are in.
    """

    waiting_point_enu_m: Array | None = None
    anchor_enu_m: Array | None = None
    ground_enu_m: Array | None = None
    frame_moves: FrameMoves = NO_MOVES


class ForecastMemory(Struct, frozen=True, kw_only=True, eq=False):
    """The forecast of the contact, and what it is made from beside the estimate.

    Attributes:
        contact: the newest forecast of this descent, None without one.
        made_ns: when it was made, monotonic; None in any other phase.
        is_committed: it was made below the commit height, where nothing is waited for any more.
        drivers: how the vehicle's driver drives.
        gusts: how hard the air pushes the drone.
        risk: that a contact is unsafe if it comes to one, a mean of the last forecasts; None while that is not seen.
        has_begun: this descent has left the height of waiting at a quiet moment; it holds until the descent ends.
        acceleration_ns: when the vehicle last told its acceleration, monotonic; None if it never did.
        turning_ns: when it last told its heading, or how fast it turns, monotonic; None if it never did.
    """

    contact: ContactForecast | None = None
    made_ns: int | None = None
    is_committed: bool = False
    drivers: Drivers = field(default_factory=Drivers)
    gusts: Gusts = field(default_factory=Gusts)
    risk: float | None = None
    has_begun: bool = False
    acceleration_ns: int | None = None
    turning_ns: int | None = None


class StepMemory(Struct, frozen=True, kw_only=True, eq=False):
    """What a step hands to the next."""

    progress: Progress = field(default_factory=Progress)
    vehicle: VehicleMemory = field(default_factory=VehicleMemory)
    model: ModelMemory = field(default_factory=ModelMemory)
    control: ControlMemory = field(default_factory=ControlMemory)
    places: Places = field(default_factory=Places)
    sortie: SortieMemory = field(default_factory=SortieMemory)
    forecast: ForecastMemory = field(default_factory=ForecastMemory)


def to_present_frame(memory: StepMemory, view: AutopilotView) -> StepMemory:
    """Return the memory, but for the vehicle's, in the frame that the autopilot's positions are in now.

    When the frame steps, all places that the companion flies to move along, so that the drone stays where it is.

    Args:
        memory: in the frame of the last step.
        view: of the autopilot now.
    """
    places = memory.places
    if view.frame_moves == places.frame_moves:
        return memory
    by_enu_m = between(places.frame_moves.shift_enu_m, view.frame_moves.shift_enu_m)
    places = replace(places, frame_moves=view.frame_moves)
    if not by_enu_m.any():
        return replace(memory, places=places)
    places = replace(
        places,
        waiting_point_enu_m=_move(places.waiting_point_enu_m, by_enu_m),
        anchor_enu_m=_move(places.anchor_enu_m, by_enu_m),
        ground_enu_m=_move(places.ground_enu_m, by_enu_m),
    )
    sortie = move_sortie(memory.sortie, by_enu_m)
    return replace(memory, places=places, sortie=sortie, model=_move_model(memory.model, by_enu_m))


def between(before_enu_m: Vector3, now_enu_m: Vector3) -> Array:
    """Return the move (3,) from the one to the other."""
    return np.subtract(now_enu_m, before_enu_m, dtype=np.float64)


def _move_model(model: ModelMemory, by_enu_m: Array) -> ModelMemory:
    reference, tracking = model.reference, model.tracking
    if reference is not None:
        reference = replace(reference, position_enu_m=reference.position_enu_m + by_enu_m)
    tracking = move_tracking(tracking, by_enu_m)
    return replace(model, reference=reference, plan=None, guidance=None, tracking=tracking)


def _move(point_enu_m: Array | None, by_enu_m: Array) -> Array | None:
    return None if point_enu_m is None else point_enu_m + by_enu_m
