"""A vehicle that is known exactly, an autopilot that follows exactly, and a companion's step between them."""

import math
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cache
from typing import Any, cast

import numpy as np

from companion.autopilots.driver import AutopilotView, Driver, Receiver
from companion.autopilots.frame_moves import FrameMoves
from companion.autopilots.px4 import Px4Driver
from companion.autopilots.response import Cascade, ResponseModel
from companion.config.companion import CompanionConfig
from companion.config.integrity import IntegrityConfig, ReceiverFrames
from companion.core.data import Array, Forecast, Measurement, OwnState, Quantity, Rival, VehicleEstimate
from companion.core.reasons import Reason, sentence
from companion.landing.state.memory import StepMemory
from companion.landing.state.step_data import StepInputs, StepOutputs, System, VehicleInputs
from companion.landing.steering.targets import HORIZON_OFFSETS_S
from companion.runtime.build import make_guidance
from companion.situation.phases import FLYING_PHASES, LANDING_PHASES, Phase
from companion.step import companion_step
from companion.vehicle.estimator import BufferHealth, Estimator
from link.frames.geodesy import Datum, LocalFrame, Projection
from link.frames.rotations import quaternion_from_yaw
from link.mavlink.dialect import mavlink
from link.messages import Command, PadGeometry, Station, Vector3
from link.program.toml_config import merge, validate
from link.records import replace
from tests.companion.health import health_of

CONFIG = CompanionConfig(integrity=IntegrityConfig(receiver_frames=ReceiverFrames.ONE))


def configured(table: Mapping[str, Any], below: CompanionConfig = CONFIG) -> CompanionConfig:
    """Return a configuration with the keys of `table`, as a file would have them, laid over those `below`."""
    return validate(CompanionConfig, merge(below.model_dump(mode="json"), table), source="the test")


IMPATIENT = configured(
    {
        "takeoff": {"refused_after_s": 3.0},
        "chase": {"parked_wait_s": 2.0},
        "descent": {"alignment": {"time_limit_s": 4.0}},
    }
)
START_NS = 1_795_000_000_000_000_000
STEP_NS = 20_000_000
UTC_AHEAD_NS = START_NS - 77_000_000_000  # of the monotonic clock
ORIGIN = Datum(latitude_rad=0.83, longitude_rad=0.14, altitude_m=400.0)
FRAME = LocalFrame(origin=ORIGIN, projection=Projection.PX4)
PAD_HEIGHT_M = 1.5
PAD = PadGeometry(size_m=(1.5, 1.5), height_m=PAD_HEIGHT_M, antenna_to_pad_m=(0.0, 0.0, 0.0))
GEAR_M = CONFIG.touchdown.gear_height_m
FLYING = sorted(FLYING_PHASES, key=lambda one: one.value)
LANDING = sorted(LANDING_PHASES, key=lambda one: one.value)
STATION = Station(offset_m=(-6.0, 2.0, 3.0))
DISARM, SET_MODE = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_DO_SET_MODE


@dataclass(frozen=True)
class KnownVehicle:
    """An estimator that knows: straight on at an even speed; the memory is the time of the newest fix."""

    start_enu_m: Vector3
    velocity_enu_m_s: Vector3
    yaw_rad: float | None = 0.3
    std_m: float = 0.05
    apart_std_m: float = math.inf

    def fuse(self, memory: int | None, measurements: Sequence[Measurement]) -> int:
        return max(memory or 0, *(measurement.t_ns for measurement in measurements))

    def estimate(self, _memory: int | None, _t_ns: int) -> VehicleEstimate | None:
        return None

    def at(self, t_ns: int) -> Array:
        return np.array(self.start_enu_m) + np.array(self.velocity_enu_m_s) * (t_ns - START_NS) * 1e-9

    def forecast(self, memory: int | None, t_ns: int, offset_s: Array) -> Forecast | None:
        if memory is None:
            return None
        n = len(offset_s)
        velocity = np.tile(self.velocity_enu_m_s, (n, 1))
        return Forecast(
            t_ns=t_ns,
            offset_s=offset_s,
            position_enu_m=self.at(t_ns) + velocity * offset_s[:, None],
            velocity_enu_m_s=velocity,
            acceleration_enu_m_s2=np.zeros((n, 3)),
            yaw_rad=None if self.yaw_rad is None else np.full(n, self.yaw_rad),
            position_std_m=np.full((n, 3), self.std_m),
            frame_offset_std_m=self.apart_std_m,
        )

    def newest_fix_ns(self, memory: int | None) -> int | None:
        return memory

    def health(self, _memory: int | None) -> BufferHealth:
        return health_of({})


def fix(t_ns: int) -> Measurement:
    """A position; `KnownVehicle` looks at its time only."""
    return Measurement(t_ns=t_ns, quantity=Quantity.POSITION, value=np.zeros(3), covariance=np.eye(3))


def own_state(t_ns: int, position_enu_m: Vector3, velocity_enu_m_s: Vector3 = (0.0, 0.0, 0.0)) -> OwnState:
    return OwnState(
        t_ns=t_ns,
        position_enu_m=position_enu_m,
        velocity_enu_m_s=velocity_enu_m_s,
        orientation_wxyz=quaternion_from_yaw(0.2),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


@cache
def _response(cascade: Cascade) -> ResponseModel:
    return ResponseModel(cascade, HORIZON_OFFSETS_S)


def response_of(driver: Driver) -> ResponseModel:
    """How an autopilot with the firmware's default gains follows setpoints."""
    return _response(driver.cascade({}))


@dataclass
class Flight:
    """The drone is where the last setpoint wanted it, but never below the pad; commands are obeyed unless refused."""

    vehicle: KnownVehicle = field(default_factory=lambda: KnownVehicle((-20.0, 0.4, PAD_HEIGHT_M), (4.0, 0.0, 0.0)))
    config: CompanionConfig = CONFIG
    pad: PadGeometry | None = PAD
    refuses: frozenset[int] = frozenset()
    refuses_plain_disarm: bool = False
    sends_fixes: bool = True
    own_is_silent: bool = False
    alive: bool | None = True
    rival: Rival | None = None
    leaving: bool = False
    stamps_ahead_s: float = 0.0
    driver: Driver = field(default_factory=Px4Driver)
    station: Station = STATION  # of a command to follow

    def __post_init__(self) -> None:
        self.memory = StepMemory()
        self.t_ns = START_NS
        self.view = AutopilotView(
            link_up=True,
            armed=False,
            in_control=False,
            failsafe=False,
            landed=True,
            frame=FRAME,
            receiver=Receiver(knows_geoid=True),
            frame_moves=FrameMoves(origin_count=1),
        )
        self.own = own_state(START_NS, (0.0, 0.0, GEAR_M))
        self.history: list[Phase] = []
        self.commands: list[tuple[Phase, int, float, float]] = []
        self.outputs: StepOutputs | None = None
        self.acknowledgements: list[tuple[int, int]] = []
        self.guidance = make_guidance(self.config.guidance.kind, self.config.guidance)

    @property
    def phase(self) -> Phase:
        return self.memory.progress.phase

    @property
    def monotonic_ns(self) -> int:
        return self.t_ns - UTC_AHEAD_NS

    @property
    def reason(self) -> Reason:
        return self.memory.progress.cause.reason

    @property
    def sentence(self) -> str:
        return sentence(self.memory.progress.cause)

    def copy(self) -> "Flight":
        other = copy(self)
        other.history, other.commands = list(self.history), list(self.commands)
        return other

    @property
    def system(self) -> System:
        return System(config=self.config, estimator=cast("Estimator", self.vehicle), guidance=self.guidance)

    def inputs(self, command: Command | None = None) -> StepInputs:
        return StepInputs(
            t_ns=self.t_ns,
            monotonic_ns=self.monotonic_ns,
            limits=self.config.limits.flight_limits(),
            own=self.own,
            autopilot=self.view,
            response=response_of(self.driver),
            driver=self.driver,
            shaping=self.driver.shaping({}),
            acknowledgements=tuple(self.acknowledgements),
            vehicle=VehicleInputs(
                measurements=(fix(self.t_ns + round(self.stamps_ahead_s * 1e9)),) if self.sends_fixes else (),
                is_alive=self.alive,
                pad=self.pad,
            ),
            rival=self.rival,
            command=command,
            station=self.station if command is Command.FOLLOW else None,
            leaving=self.leaving,
        )

    def step(self, command: Command | None = None) -> StepOutputs:
        """Make a step and let the autopilot follow it."""
        inputs = self.inputs(command)
        self.acknowledgements = []
        self.memory, outputs = companion_step(self.memory, inputs, self.system)
        self.outputs = outputs
        if not self.history or self.history[-1] is not self.phase:
            self.history.append(self.phase)
        self._obey(outputs)
        self._fly(outputs)
        self.t_ns += STEP_NS
        return outputs

    def run(self, duration_s: float) -> list[StepOutputs]:
        return [self.step() for _ in range(round(duration_s * 1e9 / STEP_NS))]

    def run_until(self, *phases: Phase, limit_s: float = 90.0) -> None:
        for _ in range(round(limit_s * 1e9 / STEP_NS)):
            if self.phase in phases:
                return
            self.step()
        raise AssertionError(f"{phases} not reached in {limit_s} s: {self.history}, {self.sentence}")

    def start_and_reach(self, phase: Phase) -> None:
        self.run(0.1)
        self.step(Command.START)
        self.run_until(phase)

    def told(self, command: int) -> list[tuple[Phase, int, float, float]]:
        """The commands of a kind: phase, command, first and second parameter."""
        return [one for one in self.commands if one[1] == command]

    def _obey(self, outputs: StepOutputs) -> None:
        for command in outputs.commands:
            first, second = command.parameters[:2]
            self.commands.append((self.phase, command.command, first, second))
            is_disarm = command.command == DISARM and first == 0.0
            if command.command in self.refuses or (is_disarm and self.refuses_plain_disarm and second == 0.0):
                self.acknowledgements.append((command.command, mavlink.MAV_RESULT_TEMPORARILY_REJECTED))
                continue
            self.acknowledgements.append((command.command, mavlink.MAV_RESULT_ACCEPTED))
            if command.command == SET_MODE:
                self.view = replace(self.view, in_control=True)
            else:
                self.view = replace(self.view, armed=first == 1.0)

    def _fly(self, outputs: StepOutputs) -> None:
        t_ns = self.t_ns + STEP_NS
        if self.own_is_silent:
            return
        setpoint = outputs.setpoint
        if setpoint is None or setpoint.velocity_enu_m_s is None or not (self.view.armed and self.view.in_control):
            self.own = replace(self.own, t_ns=t_ns, velocity_enu_m_s=(0.0, 0.0, 0.0))
            return
        ahead_s = (t_ns - setpoint.t_ns) * 1e-9
        position = np.array(setpoint.position_enu_m) + np.array(setpoint.velocity_enu_m_s) * ahead_s
        velocity = np.array(setpoint.velocity_enu_m_s)
        deck = self.vehicle.at(t_ns)
        if float(np.hypot(*(position - deck)[:2])) < 1.0 and position[2] < deck[2] + GEAR_M:
            position[2], velocity[2] = deck[2] + GEAR_M, 0.0
        x, y, z = position.tolist()
        vx, vy, vz = velocity.tolist()
        self.own = own_state(t_ns, (x, y, z), (vx, vy, vz))
        self.view = replace(self.view, landed=False)


def on_deck() -> Flight:
    """A drone that stands on a vehicle at rest."""
    flight = Flight(vehicle=KnownVehicle((3.0, 0.4, PAD_HEIGHT_M), (0.0, 0.0, 0.0)))
    flight.own = own_state(START_NS, (3.1, 0.3, PAD_HEIGHT_M + GEAR_M))
    flight.refuses_plain_disarm = True
    flight.run(0.1)
    return flight


def reached(phase: Phase) -> Flight:
    """A flight that has just come into `phase`; plain disarms are refused, as on a deck that moves."""
    return kept(phase).copy()


@cache
def kept(phase: Phase) -> Flight:
    """The same, to be looked at only."""
    flight = Flight()
    flight.refuses_plain_disarm = True
    match phase:
        case Phase.ABORT:
            flight.start_and_reach(Phase.CHASE)
            flight.step(Command.ABORT)
        case Phase.HOLD:
            flight.start_and_reach(Phase.WAITING)
            flight.step(Command.HOLD)
        case Phase.TAKEOFF:
            flight.start_and_reach(Phase.TAKEOFF)
            flight.run(1.0)  # the mode is granted and the motors turn
        case Phase.ON_DECK:
            flight = on_deck()
            flight.refuses = frozenset({DISARM})  # nor does it arm: the mode is granted, and no more
            flight.step(Command.LAUNCH)
            flight.run(1.0)
        case Phase.LIFT_OFF:
            flight = on_deck()
            flight.step(Command.LAUNCH)
            flight.run_until(phase)
        case Phase.FOLLOW:
            flight.start_and_reach(Phase.WAITING)
            flight.step(Command.FOLLOW)
        case Phase.RETURN:
            flight.start_and_reach(Phase.WAITING)
            flight.step(Command.HOLD)
            flight.run(15.0)  # the vehicle drives 60 m
            flight.step(Command.RETURN)
        case Phase.RALLY:
            flight.start_and_reach(Phase.WAITING)
            flight.step(Command.FOLLOW)
            flight.run(1.0)
            flight.sends_fixes = False
            flight.run_until(phase)
        case _:
            flight.start_and_reach(phase)
    assert flight.phase is phase
    return flight
