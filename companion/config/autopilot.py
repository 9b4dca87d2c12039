"""What can be set about the autopilot, the setpoints that it gets, and what ground stations on its link may do."""

from enum import Enum
from typing import Annotated, Self

from pydantic import Field, model_validator

from link.program.toml_config import Positive, StrictModel


class AutopilotKind(Enum):
    """What a user says of the autopilot."""

    AUTO = "auto"  # its heartbeat tells
    PX4 = "px4"
    ARDUPILOT = "ardupilot"


class Guide(Enum):
    """What the companion lands by."""

    SETPOINTS = "setpoints"
    PRECLAND = "precland"  # it tells the autopilot's own precision landing where the pad is, and commands nothing


class PadOnMap(Enum):
    """As what ground stations are told where the pad is."""

    NONE = "none"
    FOLLOW_TARGET = "follow_target"  # which an autopilot heeds in its follow mode only
    ADSB = "adsb"  # FOLLOW_TARGET, and a vehicle among the traffic, which all ground stations draw


class UtcOf(Enum):
    """Whose time of day is taken for UTC."""

    AUTOPILOT = "autopilot"
    COMPUTER = "computer"  # its date when the companion starts, carried on from there


Pulse = Annotated[int, Field(ge=800, le=2200)]


class PilotSwitchConfig(StrictModel):
    """The switch on the transmitter that starts, holds and breaks off a landing."""

    channel: Annotated[int, Field(ge=5, le=18)] | None = None  # of RC_CHANNELS; none: there is no such switch
    start_above_us: Pulse = 1800  # a longer pulse starts; both as ArduPilot has them for its own switches
    abort_below_us: Pulse = 1200  # a shorter one breaks off; between them: hold
    arms: bool = False  # a start may switch motors on, which a switch can be knocked into

    @model_validator(mode="after")
    def _has_a_middle(self) -> Self:
        if self.abort_below_us >= self.start_above_us:
            raise ValueError(f"abort_below_us must be below start_above_us, {self.start_above_us}")
        return self


class AutopilotConfig(StrictModel):
    """Which autopilot it is, and what the companion does on its link."""

    kind: AutopilotKind = AutopilotKind.AUTO  # any other than the one named is refused
    guide: Guide = Guide.SETPOINTS  # the companion flies by setpoints, or tells the autopilot's own precision landing
    # Of mean sea level above the ellipsoid, where the autopilot's receiver does not tell it; none: then no start.
    geoid_height_m: Annotated[float, Field(ge=-120.0, le=120.0)] | None = None
    utc: UtcOf = UtcOf.AUTOPILOT  # the computer's where NTP or GNSS keeps it, before the companion starts
    pilot_switch: PilotSwitchConfig = PilotSwitchConfig()
    stops_unused_streams: bool = True  # on the companion's own link; false where others listen on it, too


class GroundStationConfig(StrictModel):
    """What ground stations and dashboards may ask, and what they are told."""

    # Whoever sends to the autopilot's link can start and break off a landing by it, as it can command the autopilot.
    takes_mavlink_commands: bool = True
    pad_on_map: PadOnMap = PadOnMap.FOLLOW_TARGET  # told at 2 Hz, by MAVLink
    status_rate_hz: Annotated[float, Field(ge=0.5, le=50.0)] = 10.0


class SetpointConfig(StrictModel):
    """How often setpoints are sent, what they say, and when they are for."""

    rate_hz: Annotated[float, Field(ge=10.0, le=200.0)] = 50.0
    # By which they are ahead of the drone beside the link's delay; none: as the autopilot takes them.
    lead_s: Annotated[float, Field(ge=0.0, le=0.5)] | None = None
    yaw_rate_max_rad_s: Positive = 0.8  # ArduCopter slews at 60 degrees a second
    position_only: bool = False  # leave velocity and acceleration out, as the source report does
    corrects_lag: bool = True  # plan by how far the drone will be off its setpoints
    follows_heading: bool = True  # turn with the vehicle; False keeps the heading of the start
