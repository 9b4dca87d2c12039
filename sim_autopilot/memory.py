"""What the autopilot's step is told once, what it remembers, what comes in and what goes out."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import pi

import numpy as np

from link.frames.geodesy import Datum
from link.frames.local_frame import LocalFrame
from link.mavlink.dialect import Message
from link.messages import Vector3
from sim_autopilot.data import Array, Deck, PlantState, Reference
from sim_autopilot.firmware.firmware import Firmware
from sim_autopilot.flight.climb import Climb
from sim_autopilot.flight.flight import ModeFlight, begin
from sim_autopilot.flight.land_detector import Landing
from sim_autopilot.flight.modes import Modes
from sim_autopilot.local_places import Origin
from sim_autopilot.own_state import NO_ERROR, OwnStateModel
from sim_autopilot.parameters import Values, default_values
from sim_autopilot.plant import PlantConfig, PlantMemory, initial_plant
from sim_autopilot.services import Services
from sim_autopilot.setpoints.guided import Guided, begin_guided
from sim_autopilot.setpoints.setpoints import NO_SETPOINTS, Setpoints
from sim_autopilot.settings import FlightSettings
from sim_autopilot.snapshot import Snapshot, take_snapshot
from sim_autopilot.streams import Streams, default_streams
from sim_autopilot.telemetry.chart import Chart, chart_at


@dataclass(frozen=True, slots=True, kw_only=True)
class AutopilotConfig:
    """What does not change while the autopilot runs.

    Attributes:
        firmware: which one it stands in for.
        datum: origin of W, a tangent plane, and of the autopilot's local frame at boot.
        plant: the drone; the parameters' limits take the place of its envelope's.
        system_id: MAVLink system.
        instant: ready at once, without the seconds that a boot takes.
        position_enu_m: where the drone stands at boot, its centre of mass.
        yaw_rad: its heading there.
        parameters: values that differ from the firmware's defaults.
        endurance_s: of motors running on one battery.
        own_state: how well it knows where it is.
        links: of each MAVLink link the rates at which it streams by default, in Hz by message id; None for the
            firmware's own.
    """

    firmware: Firmware
    datum: Datum
    plant: PlantConfig = field(default_factory=PlantConfig)
    system_id: int = 1
    instant: bool = False
    position_enu_m: Vector3 = (0.0, 0.0, 0.12)
    yaw_rad: float = pi / 2.0
    parameters: Values = field(default_factory=dict)
    endurance_s: float = 1200.0
    own_state: OwnStateModel = field(default_factory=OwnStateModel)
    links: tuple[Mapping[int, float] | None, ...] = (None,)


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkMemory:
    """What belongs to one MAVLink link; see the attributes of the same names in `AutopilotMemory`."""

    streams: Streams
    listing: int | None = None
    ground_station: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Later:
    """A message to be sent at `boot_ns`, on the links on which its target is."""

    boot_ns: int
    message: Message


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AutopilotMemory:
    """Everything that the autopilot knows from one step to the next.

    Attributes:
        start_ns: UTC at boot.
        plant: the drone.
        now: the same as the autopilot believes it to be, in plain numbers.
        plant_config: with the envelope that the parameters set.
        values: of the parameters.
        settings: what these amount to.
        modes: flown and intended.
        flight: what the mode remembers.
        guided: what ArduCopter's GUIDED remembers.
        climb: the lift-off under way.
        armed_ns: when the motors were started, in ns since boot; None with the motors off.
        landing: of the land detector.
        setpoints: the companion's.
        streams: what is sent unasked.
        origin: of the local frame.
        home_enu_m: where it was armed.
        chart: for geodetic coordinates.
        later: messages to be sent.
        listing: index of the next parameter of a list under way.
        ground_station: whether one was heard, or anybody at all where everybody counts: who gets texts.
        link: number of the link at hand, whose are streams, listing and ground_station.
        links: the same of every link, as it was when that was last at hand.
        following: what the flight controller was last told.
        deck: the vehicle, for the range finder.
        wind_enu_m_s: the air, for WIND_COV.
        services: of missions, battery, fence and the like.
    """

    start_ns: int
    plant: PlantMemory
    now: Snapshot
    plant_config: PlantConfig
    values: Values
    settings: FlightSettings
    modes: Modes
    flight: ModeFlight
    guided: Guided
    climb: Climb | None
    armed_ns: int | None
    landing: Landing
    setpoints: Setpoints
    streams: Streams
    origin: Origin
    home_enu_m: Vector3
    chart: Chart
    later: tuple[Later, ...]
    listing: int | None
    ground_station: bool
    link: int
    links: tuple[LinkMemory, ...]
    following: Reference | None
    deck: Deck | None
    wind_enu_m_s: Vector3
    services: Services


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AutopilotInputs:
    """What the autopilot gets for one step, which ends at `t_ns` (UTC).

    Attributes:
        t_ns: 10 ms after the last one.
        messages: received since then, decoded.
        links: the number of the link of each of them; empty when all came on the first.
        deck: the vehicle at its own time, None without one.
        wind_enu_m_s: (3,).
        own_error: (6,) m and m/s in W, of the autopilot's estimate of its position and velocity.
    """

    t_ns: int
    messages: tuple[Message, ...]
    deck: Deck | None
    wind_enu_m_s: Array
    own_error: Array = field(default_factory=lambda: NO_ERROR)
    links: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AutopilotOutputs:
    """What the autopilot sends, and the truth.

    Attributes:
        messages: to be sent, in order.
        links: the number of the link of each of them, None for wherever its target is, everywhere without a target.
        state: the drone as it truly is.
    """

    messages: tuple[Message, ...]
    links: tuple[int | None, ...]
    state: PlantState


def initial_memory(config: AutopilotConfig, start_ns: int) -> AutopilotMemory:
    """Return an autopilot that starts at `start_ns`, disarmed, its drone at rest.

    Raises:
        ValueError: a parameter of `config` does not exist or is out of range.
    """
    firmware = config.firmware
    values = default_values(firmware.parameters, {firmware.system_id_parameter: config.system_id, **config.parameters})
    settings = firmware.settings(values)
    plant = initial_plant(config.plant, start_ns, np.array(config.position_enu_m), config.yaw_rad)
    now = take_snapshot(plant.state, config.plant.airframe, 0)
    links = tuple(LinkMemory(streams=default_streams(firmware.streams.values(), rates)) for rates in config.links)
    return AutopilotMemory(
        start_ns=start_ns,
        plant=plant,
        now=now,
        plant_config=limited(config.plant, settings),
        values=values,
        settings=settings,
        modes=Modes(mode=firmware.boot_mode, intended=firmware.boot_mode),
        flight=begin(firmware.boot_mode, now, now.position_enu_m, settings),
        guided=begin_guided(now),
        climb=None,
        armed_ns=None,
        landing=Landing(),
        setpoints=NO_SETPOINTS,
        streams=links[0].streams,
        origin=Origin(world=config.datum, frame=LocalFrame(origin=config.datum, projection=firmware.projection)),
        home_enu_m=now.position_enu_m,
        chart=chart_at(config.datum, now.position_enu_m),
        later=(),
        listing=None,
        ground_station=False,
        link=0,
        links=links,
        following=None,
        deck=None,
        wind_enu_m_s=(0.0, 0.0, 0.0),
        services=Services(),
    )


def has_passed(config: AutopilotConfig, memory: AutopilotMemory, since_boot_s: float) -> bool:
    """Return whether so much time has passed since boot, or need not."""
    return config.instant or memory.now.boot_ns * 1e-9 >= since_boot_s


def limited(plant: PlantConfig, settings: FlightSettings) -> PlantConfig:
    """Return `plant` with the envelope that the parameters set."""
    envelope = replace(
        plant.envelope,
        speed_max_m_s=settings.speed_max_m_s,
        climb_max_m_s=settings.climb_max_m_s,
        descent_max_m_s=settings.descent_max_m_s,
        braking_m_s2=settings.braking_m_s2,
        tilt_max_rad=settings.tilt_max_rad,
        yaw_rate_max_rad_s=settings.yaw_rate_max_rad_s,
    )
    return replace(plant, envelope=envelope, gains=settings.gains)
