"""What goes into a companion step and what comes out; `memory.py` holds what it remembers in between."""

from msgspec import Struct

from companion.autopilots.driver import NO_AUTOPILOT, AutopilotCommand, AutopilotView, Driver
from companion.autopilots.response import ResponseModel, Shaping
from companion.config.companion import CompanionConfig
from companion.core.data import FlightLimits, Measurement, OwnState, Rival, Setpoint
from companion.planning.guidance import Guidance, PlanResult, Trajectory
from companion.vehicle.estimator import Estimator
from companion.vehicle.pad import PadPath
from link.messages import Command, CommandReply, LandingStatus, PadGeometry, Station
from link.records import replace


class System(Struct, frozen=True, kw_only=True, eq=False):
    """The parts that a companion is made of; none of them changes during a flight."""

    config: CompanionConfig
    estimator: Estimator
    guidance: Guidance


class LinkDelay(Struct, frozen=True, kw_only=True):
    """How long a message takes, by how much that differs from one to the next, and how long none may have come.

    Attributes:
        mean_s: mean time that a message is on its way.
        std_s: standard deviation of that time.
        unanswered_s: since the newest question was asked that the autopilot has answered.
        answering_s: how long ago answers began to come without a gap; None of an autopilot that gives none.
    """

    mean_s: float = 0.0
    std_s: float = 0.0
    unanswered_s: float = 0.0
    answering_s: float | None = None


class VehicleInputs(Struct, frozen=True, kw_only=True, eq=False):
    """What has come from the vehicle.

    Attributes:
        measurements: received since the last step, sightings of its pad included.
        fix_ahead_s: by which the newest fix since then came before its stamp, so that it was refused; None if none was.
        has_doubted_unit: something that its inertial unit tells has since then been found to be wrong.
        is_alive: its liveliness token is there; None when it never showed one.
        pad: its own description of its pad.
        is_pad_doubted: it describes another one now, as one that was restarted with another file.
        has_unplaced_sightings: all that came lately are stamped when nobody knew where the drone was.
    """

    measurements: tuple[Measurement, ...] = ()
    fix_ahead_s: float | None = None
    has_doubted_unit: bool = False
    is_alive: bool | None = None
    pad: PadGeometry | None = None
    is_pad_doubted: bool = False
    has_unplaced_sightings: bool = False


class StepInputs(Struct, frozen=True, kw_only=True, eq=False):
    """What a step is told.

    Attributes:
        t_ns: now, UTC; it may be set.
        monotonic_ns: now, on a clock that goes as UTC does and is never set, for spans of time.
        response: how the autopilot follows setpoints; None while none is connected.
        own: the drone's newest report, None before the first.
        autopilot: as its messages tell.
        driver: of the connected autopilot, None while none is connected.
        limits: of the flight, from the configuration and the autopilot's parameters.
        acknowledgements: (command, MAV_RESULT) received since the last step.
        vehicle: what has come from it.
        rival: a companion that this one keeps out of the way of, None without one.
        command: an operator's wish.
        station: of a command to follow, None with any other.
        leaving: the companion is about to end, so the autopilot is to hover by itself, or to finish its disarm.
        link_delay: from the companion to the autopilot.
        shaping: of the path by which the autopilot carries setpoints on; None of one that holds them as they came.
    """

    t_ns: int
    monotonic_ns: int
    limits: FlightLimits
    response: ResponseModel | None = None
    own: OwnState | None = None
    autopilot: AutopilotView = NO_AUTOPILOT
    driver: Driver | None = None
    acknowledgements: tuple[tuple[int, int], ...] = ()
    vehicle: VehicleInputs = VehicleInputs()
    rival: Rival | None = None
    command: Command | None = None
    station: Station | None = None
    leaving: bool = False
    link_delay: LinkDelay = LinkDelay()
    shaping: Shaping | None = None

    def monotonic_at(self, t_ns: int) -> int:
        """Return the monotonic time of a stamp in UTC."""
        return t_ns - self.t_ns + self.monotonic_ns

    def ahead_s(self, config: CompanionConfig) -> float:
        """Return how long after the step its setpoint takes effect."""
        lead_s = config.setpoints.lead_s
        if lead_s is None:
            lead_s = 0.0 if self.response is None else self.response.cascade.lead_s
        return self.link_delay.mean_s + lead_s


class StepOutputs(Struct, frozen=True, kw_only=True, eq=False):
    """What a step wants done.

    Attributes:
        setpoint: to be sent; None while the companion flies nothing.
        commands: to be sent and acknowledged.
        text: for the pilot, None when there is nothing new.
        reply: to the operator's command, None when there was none.
        status: for the world.
        plan: of this step, None while nothing is flown; it begins as the setpoint takes effect.
        pad: as this step knew it, None while it is not known.
    """

    setpoint: Setpoint | None
    commands: tuple[AutopilotCommand, ...]
    text: str | None
    reply: CommandReply | None
    status: LandingStatus
    plan: PlanResult | None
    pad: PadPath | None = None

    def way_from(self, t_ns: int) -> Trajectory | None:
        """Return the planned way with its offsets from `t_ns`, UTC; None while nothing is flown."""
        if self.plan is None or self.setpoint is None:
            return None
        way = self.plan.trajectory
        return replace(way, offset_s=way.offset_s + (self.setpoint.t_ns - t_ns) * 1e-9)
