"""What goes into a companion step, what comes out, and what it remembers in between."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from companion.autopilots.driver import NO_AUTOPILOT, AutopilotCommand, AutopilotView, Driver, DriverMemory
from companion.config.companion import CompanionConfig
from companion.core.data import Array, FlightLimits, Measurement, OwnState, Setpoint
from companion.integrity.contradictions import Contradictions
from companion.integrity.course import CourseWatch
from companion.integrity.fix_stamps import FixStamps
from companion.landing.sway import Sway
from companion.landing.virtual_model import Tracking
from companion.planning.guidance import Guidance, PlanResult, ReferenceState
from companion.situation.phases import Phase
from companion.vehicle.estimator import Estimator
from companion.vehicle.surprise import Surprise
from link.messages import Command, CommandReply, LandingStatus, PadGeometry, Vector3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class System:
    """The parts that a companion is made of; none of them changes during a flight."""

    config: CompanionConfig
    estimator: Estimator
    guidance: Guidance


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepInputs:
    """What a step is told.

    Attributes:
        t_ns: now, UTC.
        own: the drone's newest report, None before the first.
        autopilot: as its messages tell.
        driver: of the connected autopilot, None while none is connected.
        limits: of the flight, from the configuration and the autopilot's parameters.
        acknowledgements: (command, MAV_RESULT) received since the last step.
        measurements: of the vehicle, received since the last step.
        vehicle_alive: its liveliness token; None when it never showed one.
        pad: the vehicle's own description of its pad.
        command: an operator's wish.
        leaving: the companion is about to end, so the autopilot is to hover by itself, or to finish its disarm.
        link_delay_s: from the companion to the autopilot.
        link_delay_std_s: its standard deviation.
        timeout_s: for how long the autopilot goes on without a setpoint.
    """

    t_ns: int
    limits: FlightLimits
    own: OwnState | None = None
    autopilot: AutopilotView = NO_AUTOPILOT
    driver: Driver | None = None
    acknowledgements: tuple[tuple[int, int], ...] = ()
    measurements: tuple[Measurement, ...] = ()
    vehicle_alive: bool | None = None
    pad: PadGeometry | None = None
    command: Command | None = None
    leaving: bool = False
    link_delay_s: float = 0.0
    link_delay_std_s: float = 0.0
    timeout_s: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepOutputs:
    """What a step wants done.

    Attributes:
        setpoint: to be sent; None while the companion flies nothing.
        commands: to be sent and acknowledged.
        text: for the pilot, None when there is nothing new.
        reply: to the operator's command, None when there was none.
        status: for the world.
        plan: of this step, None while nothing is flown.
    """

    setpoint: Setpoint | None
    commands: tuple[AutopilotCommand, ...]
    text: str | None
    reply: CommandReply | None
    status: LandingStatus
    plan: PlanResult | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StepMemory:
    """What a step hands to the next.

    Attributes:
        phase: of the landing.
        phase_since_ns: when it began; a chase that goes on after an outage, when it began first.
        reason: why it began.
        retries: landings aborted since the start.
        interrupted_ns: when the chase began that an outage has broken off; None when an abort counts.
        begun_anew: how often this approach has been aligned or chased again, by the reason.
        waits_since_ns: when it began to wait above a vehicle that has surprised; None while it does not.
        waited_s: for how long it has done so before, in this phase.
        may_retry: no operator has broken the landing off since the start.
        was_in_control: the autopilot's mode has been the companion's since the start.
        was_armed: and its motors were armed in that mode.
        estimator: the estimator's own memory.
        guidance: the guidance law's own memory.
        driver: the driver's memory.
        reference: the virtual model, None while nothing is flown.
        reference_ns: the model's time.
        tracking: how the drone follows it.
        sway: how hard the drone leans.
        surprise: how the vehicle drives against what was expected.
        fix_stamps: whether its fixes come from the future.
        contradictions: of the vehicle's data.
        course: how the vehicle's heading compares with its course.
        stopped_by_pad: the contact was a jolt.
        held: since when each test has been true.
        obstacle: name of what makes a landing impossible, and the sentence that told it; None without one.
        waiting_point_enu_m: (3,) in W.
        ground_enu_m: (3,) of the ground, in W.
        is_road_elsewhere: the vehicle is said to be far above or below it.
        anchor_enu_m: (3,) where a hover phase stays.
        lowest_enu_m: height in W below which this step's plan does not go.
        yaw_setpoint_rad: last one sent.
        origin_count: of the frame that the estimate is in.
        frame_shift_enu_m: likewise.
        pad_raised_m: by the range finder, in the drone's frame.
    """

    phase: Phase = Phase.IDLE
    phase_since_ns: int = 0
    reason: str = "waiting for a start"
    retries: int = 0
    interrupted_ns: int | None = None
    begun_anew: Mapping[str, int] = field(default_factory=dict)
    waits_since_ns: int | None = None
    waited_s: float = 0.0
    may_retry: bool = True
    was_in_control: bool = False
    was_armed: bool = False
    estimator: Any = None
    guidance: Any = None
    driver: DriverMemory = field(default_factory=DriverMemory)
    reference: ReferenceState | None = None
    reference_ns: int = 0
    tracking: Tracking = field(default_factory=Tracking)
    sway: Sway = field(default_factory=Sway)
    surprise: Surprise = field(default_factory=Surprise)
    fix_stamps: FixStamps = field(default_factory=FixStamps)
    contradictions: Contradictions = field(default_factory=Contradictions)
    course: CourseWatch = field(default_factory=CourseWatch)
    stopped_by_pad: bool = False
    held: Mapping[str, int] = field(default_factory=lambda: MappingProxyType({}))
    obstacle: tuple[str, str] | None = None
    waiting_point_enu_m: Array | None = None
    anchor_enu_m: Array | None = None
    ground_enu_m: Array | None = None
    is_road_elsewhere: bool = False
    lowest_enu_m: float = -math.inf
    yaw_setpoint_rad: float = 0.0
    origin_count: int = 0
    frame_shift_enu_m: Vector3 = (0.0, 0.0, 0.0)
    pad_raised_m: float = 0.0
