"""What can be set about `sim-autopilot`: one TOML file, validated once, every value with its unit and source."""

from math import pi
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from link.program.toml_config import Coordinate, NotNegative, Positive, StrictModel

_ALTITUDE_MIN_M, _ALTITUDE_MAX_M = -500.0, 9000.0  # from the shore of the Dead Sea to the highest mountain
_SPEED_MAX_M_S = 60.0  # of a vehicle on whose deck a drone stands, 216 km/h
_Speed = Annotated[float, Field(ge=-_SPEED_MAX_M_S, le=_SPEED_MAX_M_S)]
Place = tuple[Coordinate, Coordinate, Annotated[float, Field(ge=_ALTITUDE_MIN_M, le=_ALTITUDE_MAX_M)]]
"""In W, m."""
RangeEnd = Annotated[float, Field(ge=0.0, le=655.0)]
"""Of a range finder, m: DISTANCE_SENSOR tells centimetres in 16 bits."""


class DatumConfig(StrictModel):
    """The origin of W on the WGS 84 ellipsoid; by default on the Tempelhofer Feld, a former airfield in Berlin."""

    latitude_deg: Annotated[float, Field(ge=-90.0, le=90.0)] = 52.4733
    longitude_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = 13.4017
    altitude_m: Annotated[float, Field(ge=_ALTITUDE_MIN_M, le=_ALTITUDE_MAX_M)] = 89.0


class StartConfig(StrictModel):
    """Where the drone stands at boot."""

    position_enu_m: Place = (0.0, 0.0, 0.0)  # of the point under its feet
    yaw_rad: Annotated[float, Field(ge=-pi, le=pi)] = 0.0
    velocity_enu_m_s: tuple[_Speed, _Speed, _Speed] = (0.0, 0.0, 0.0)  # on the deck of a vehicle that drives


class DroneConfig(StrictModel):
    """The drone and its flight controller; what is given beside the airframe's name is in place of its own."""

    airframe: Literal["report", "benchmark", "arducopter", "px4"] = "benchmark"
    mass_kg: Annotated[float, Field(ge=0.5, le=6.0)] | None = None  # of the same size; the inertia grows with it
    thrust_to_weight: Annotated[float, Field(ge=1.2, le=10.0)] | None = None
    drag_n_s_m: Annotated[float, Field(ge=0.0, le=5.0)] | None = None
    motor_time_constant_s: Annotated[float, Field(gt=0.0, le=0.5)] | None = None
    controller: Literal["lqr", "lqr_feedforward", "geometric"] = "geometric"
    friction_coefficient: Annotated[float, Field(ge=0.0, le=2.0)] = 0.8  # rubber on painted metal
    ground_effect: bool = True
    solid: bool = True  # False: a flying drone passes through ground and vehicle; the report's simulation has neither
    endurance_s: Positive = 1200.0


class WindConfig(StrictModel):
    """Mean wind, turbulence and a discrete gust (MIL-F-8785C, low altitude)."""

    mean_m_s: Annotated[float, Field(ge=0.0, le=40.0)] = 0.0
    from_rad: Annotated[float, Field(ge=-pi, le=pi)] | None = None  # from East counter-clockwise; None: by the seed
    turbulence: Literal["none", "light", "moderate", "severe"] = "none"
    turbulence_std_m_s: Annotated[float, Field(ge=0.0, le=10.0)] | None = None  # vertical; in place of the severity's
    gust_m_s: Annotated[float, Field(ge=0.0, le=40.0)] = 0.0  # its peak; 0 is none
    gust_from_rad: Annotated[float, Field(ge=-pi, le=pi)] = 0.0  # from East counter-clockwise
    gust_start_s: NotNegative = 0.0  # since boot
    gust_duration_s: Positive = 3.0


RECEIVER_ACCURACY_MIN_M = 0.01
"""A receiver never states less."""


class OwnStateConfig(StrictModel):
    """How well the autopilot knows its own state; all zero is the truth."""

    position_std_m: NotNegative = 0.0  # on each axis
    height_std_m: NotNegative | None = None  # of the height, a barometer's; None: as on the others
    velocity_std_m_s: NotNegative = 0.0  # on each axis
    # What its receiver states, horizontally; None: as well as the drone knows its place, but for a centimetre.
    receiver_accuracy_m: Positive | None = None
    position_time_s: Positive = 10.0  # of both errors' memory; sim_autopilot/plant/own_state.py says why
    velocity_time_s: Positive = 2.0
    # How far the local frame's origin moves in flight.
    origin_step_enu_m: tuple[Coordinate, Coordinate, Coordinate] | None = None
    origin_step_s: NotNegative = 0.0  # since boot, when it does


class RangeLimits(StrictModel):
    """A range finder's range, which begins before it ends."""

    min_m: RangeEnd
    max_m: RangeEnd

    @model_validator(mode="after")
    def _ends_in_order(self) -> Self:
        if self.min_m >= self.max_m:
            raise ValueError(f"min_m must be less than max_m, {self.max_m:g}")
        return self


class RangeFinderConfig(RangeLimits):
    """What looks down along the drone's body."""

    white_std_m: NotNegative = 0.0  # of a reading
    min_m: RangeEnd = 0.0  # of its range; what is nearer or farther is told as the range's end
    max_m: RangeEnd = 100.0  # of its range


class SuperstructureConfig(StrictModel):
    """A box that stands on a deck, in the wind."""

    length_m: Positive
    width_m: Positive
    height_m: Positive  # above the deck
    rear_m: Coordinate  # its rear face, ahead of the deck's middle


class VehicleConfig(StrictModel):
    """The vehicle's body, which its truth does not tell; its roof is as high as the pad it tells of."""

    length_m: Positive = 4.2
    width_m: Positive = 1.8
    roof_height_m: NotNegative = 1.5  # until the vehicle tells its pad's height; MBZIRC 2017
    is_afloat: bool = False  # until the vehicle tells its pad
    superstructure: SuperstructureConfig | None = None  # None: the body itself is in the wind


class LinkConfig(StrictModel):
    """A MAVLink link."""

    device: str  # udpout:HOST:PORT, udpout:HOST:PORT:OWN_PORT, udpin:HOST:PORT, tcp:, tcpin: or /dev/ttyX,BAUD
    streams: Literal["onboard", "ground"] = "onboard"  # what it sends unasked, where the firmware makes a difference


class SimAutopilotConfig(StrictModel):
    """Everything that can be set about the simulated autopilot."""

    firmware: Literal["px4", "ardupilot"] = "px4"
    core: bool = False  # the flight alone: no files, logs, uploads of plans, calibration, shell and the like
    instance: Annotated[int, Field(ge=0, le=249)] = 0  # system id - 1; shifts the default ports
    instant: bool = False  # ready at once, without the seconds that a boot takes
    seed: Annotated[int, Field(ge=0)] = 1  # of the wind and the own state's errors
    datum: DatumConfig = DatumConfig()
    start: StartConfig = StartConfig()
    drone: DroneConfig = DroneConfig()
    wind: WindConfig = WindConfig()
    own_state: OwnStateConfig = OwnStateConfig()
    range_finder: RangeFinderConfig = RangeFinderConfig()
    vehicle: VehicleConfig = VehicleConfig()
    links: tuple[LinkConfig, ...] = ()  # empty: those of the firmware's own simulator, one link within `scenarios`
    parameters: dict[str, float] = Field(default_factory=dict)  # firmware parameters that differ from their defaults
