"""A scenario: everything about an experiment but its seed, validated once, each number with its unit.

Presets and tracks live as TOML in `scenarios/catalogue`; the numbers of the sensor presets are the benchmark's.
"""

import math
from typing import Annotated, Any, Literal, get_args

from pydantic import Field

from companion.config.companion import CompanionConfig
from link.messages import PadGeometry
from link.program.toml_config import Ascending, Coordinate, NotNegative, Positive, Range, StrictModel
from scenarios.tracks.config import TrackConfig
from sim_autopilot.runtime.config import DatumConfig, DroneConfig, Place, RangeEnd, RangeLimits, SuperstructureConfig

Share = Annotated[float, Field(ge=0.0, le=1.0)]
Angle = Annotated[float, Field(ge=-math.pi, le=math.pi)]
"""Mathematical, in rad; degrees are refused."""

_Rate = Annotated[float, Field(ge=0.01, le=1000.0)]
"""In Hz; what comes more seldom than every 100 s is not there in a landing."""

FirmwareName = Literal["px4", "ardupilot"]
FIRMWARES: tuple[FirmwareName, ...] = get_args(FirmwareName)


class DelayConfig(StrictModel):
    """How late and how often samples arrive; a jitter beyond the period puts them out of order."""

    rate_hz: _Rate
    delay_s: NotNegative = 0.0
    jitter_s: NotNegative = 0.0  # evenly, to either side of the delay
    loss: Share = 0.0


class FixConfig(DelayConfig):
    """A GNSS receiver's position: white noise and a first-order Gauss-Markov bias on each axis."""

    white_m: NotNegative
    white_shared: bool = False  # one draw for the three axes of a sample
    bias_m: NotNegative = 0.0  # standard deviation
    bias_tau_s: Positive = 60.0


class VelocityConfig(DelayConfig):
    """A GNSS receiver's velocity."""

    white_m_s: NotNegative


class ImuConfig(DelayConfig):
    """Attitude, turn rates and acceleration; a plain compass errs slowly, hence the Gauss-Markov part."""

    heading_white_rad: NotNegative
    heading_bias_rad: NotNegative = 0.0
    heading_bias_tau_s: Positive = 60.0
    yaw_rate_white_rad_s: NotNegative  # of the other two axes as well
    tilt_white_rad: NotNegative | None = None  # of roll and pitch; None: it tells neither
    tilt_bias_rad: NotNegative = 0.0  # standard deviation of what does not change in a run
    acceleration_white_m_s2: NotNegative | None = None  # on each axis; None: it tells no acceleration
    acceleration_bias_m_s2: NotNegative = 0.0  # standard deviation of what does not change in a run


class PatternConfig(DelayConfig):
    """A detector of the landing pattern, in a camera that looks down from the drone's centre."""

    range_share: NotNegative = 0.01  # standard deviation on each axis, as a share of the range
    white_m: NotNegative = 0.01  # and what comes on top
    white_rad: NotNegative = 0.02  # on each axis of the pad's attitude
    range_min_m: NotNegative = 0.3
    range_max_m: Positive = 12.0
    half_field_of_view_rad: Annotated[float, Field(gt=0.0, lt=1.5708)] = 0.6981  # 40 degrees
    dropout_share_range: Annotated[tuple[Share, Share], Ascending] = (0.0, 0.0)  # without sightings; drawn
    dropout_mean_s: Positive = 0.5  # length of one dropout


class CameraConfig(DelayConfig):
    """A camera on the drone, whose rendered frames the detector itself looks at; without light there is none.

    The delay is from the middle of the exposure to the message: 10 ms of reading out, 10 ms of transfer, and the search
    or the tracking on a small computer.
    """

    rate_hz: _Rate = 30.0
    delay_s: NotNegative = 0.06
    daylight_lx: Annotated[float, Field(ge=0.0, le=150_000.0)] = 0.0  # on level ground
    lamp_lm: Annotated[float, Field(ge=0.0, le=50_000.0)] = 0.0  # beside the camera, in a cone of 90 degrees
    sun_elevation_range_rad: Annotated[tuple[float, float], Ascending] | None = None  # drawn; None: overcast, or night
    is_glossy: bool = False  # the board mirrors the sun
    dirt_share: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0  # of the board, covered by mud and droppings
    readout_s: Annotated[float, Field(ge=0.0, le=0.1)] = 0.0  # from the first row to the last; 0: a global shutter
    wet_share: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0  # of the camera's window, covered by drops

    @property
    def sees(self) -> bool:
        """Whether there is a camera."""
        return self.daylight_lx > 0.0 or self.lamp_lm > 0.0


class ClockConfig(StrictModel):
    """The vehicle's clock against the drone's; offset and drift are drawn evenly, to either side, for each seed."""

    offset_max_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    drift_max: Annotated[float, Field(ge=0.0, le=1e-2)] = 0.0


class OwnStateConfig(StrictModel):
    """How well the autopilot knows its own state; all zero is the truth."""

    position_std_m: NotNegative = 0.0  # on each axis, as are the velocity's
    height_std_m: NotNegative | None = None  # of the height; None: as on the others
    velocity_std_m_s: NotNegative = 0.0
    origin_step_range_m: Range = (0.0, 0.0)  # one step of its origin in flight, drawn
    origin_step_at_s: NotNegative | None = None  # since the start; within `disturbed_between_s` where None


class RangeConfig(RangeLimits):
    """The drone's range finder; by default one that is always right."""

    white_m: NotNegative = 0.0  # of a reading
    min_m: RangeEnd = 0.0  # of its range; what is nearer or farther is told as the range's end
    max_m: RangeEnd = 100.0  # of its range


class SensorsConfig(StrictModel):
    """The sensors on the vehicle and for the vehicle, and the drone's own; None where there is none."""

    fix: FixConfig
    velocity: VelocityConfig | None = None
    imu: ImuConfig | None = None
    pattern: PatternConfig | None = None
    # Between the two receivers' frames, horizontal, in a drawn direction; 0: of one source of corrections, and whoever
    # flies knows it.
    frame_offset_m: NotNegative = 0.0
    clock: ClockConfig = ClockConfig()
    own_state: OwnStateConfig = OwnStateConfig()
    range_finder: RangeConfig = RangeConfig()


class WindConfig(StrictModel):
    """Mean wind from a direction (drawn for each seed where None) and its turbulence (MIL-F-8785C)."""

    mean_m_s: Annotated[float, Field(ge=0.0, le=40.0)] = 0.0
    from_rad: Angle | None = None  # from East counter-clockwise, that the wind blows from
    turbulence: Literal["none", "light", "moderate", "severe"] = "none"
    turbulence_std_m_s: Annotated[float, Field(ge=0.0, le=10.0)] | None = None  # vertical; in place of the severity's
    gust_m_s: Annotated[float, Field(ge=0.0, le=40.0)] = 0.0  # peak of one 1-cosine gust from a drawn direction
    gust_duration_s: Positive = 3.0  # from calm to calm; in 5 m/s of airspeed it rises over d_m = 7.5 m
    gust_from_rad: Angle | None = None  # drawn for each seed where None
    gust_at_s: NotNegative | None = None  # since the start; within the scenario's `disturbed_between_s` where None


class ChannelConfig(StrictModel):
    """One direction of a link."""

    delay_s: NotNegative = 0.0
    jitter_s: NotNegative = 0.0
    loss: Share = 0.0
    outage_range_s: Range = (0.0, 0.0)  # length of one outage, drawn
    outage_at_s: NotNegative | None = None  # since the start; within the scenario's `disturbed_between_s` where None


class LinkConfig(StrictModel):
    """The links of the companion."""

    mavlink: ChannelConfig = ChannelConfig()  # to and from the autopilot
    zenoh: ChannelConfig = ChannelConfig()  # from the vehicle
    detector: ChannelConfig = ChannelConfig()  # from the landing pattern's, which is on the drone as the companion is


class VehicleConfig(StrictModel):
    """The vehicle's body and the pad in the middle of its roof; V begins on the road under the body's middle."""

    length_m: Positive = 4.2
    width_m: Positive = 1.8
    roof_height_m: NotNegative = 1.5  # MBZIRC 2017
    pad_size_m: tuple[Positive, Positive] = (1.5, 1.5)  # MBZIRC 2017
    antenna_flu_m: tuple[Coordinate, Coordinate, Coordinate] = (-1.2, 0.5, 1.6)
    is_afloat: bool = False
    superstructure: SuperstructureConfig | None = None  # a hangar; None: the body itself is in the wind

    @property
    def pad(self) -> PadGeometry:
        """The pad as the vehicle tells it."""
        x_m, y_m, z_m = self.antenna_flu_m
        lever_m = (-x_m, -y_m, self.roof_height_m - z_m)
        return PadGeometry(
            size_m=self.pad_size_m, height_m=self.roof_height_m, antenna_to_pad_m=lever_m, is_afloat=self.is_afloat
        )


class SystemConfig(StrictModel):
    """What flies: the companion's configuration and the drone's.

    A scenario that is faster than a firmware's own limits raises them by `parameters`.
    """

    companion: CompanionConfig = CompanionConfig()
    drone: DroneConfig = DroneConfig()
    parameters: dict[FirmwareName, dict[str, float]] = Field(default_factory=dict)  # that differ from the defaults


class RunConfig(StrictModel):
    """Where and in what state a run begins, where it is bounded, and when something happens and it ends."""

    start: Literal["instant", "boot"] = "instant"  # of the autopilot in lockstep; over the wire it always boots
    place: Literal["road", "deck"] = "road"  # where the drone stands at first; under one on its deck the vehicle drives
    datum: DatumConfig = DatumConfig()
    drone_start_enu_m: Place = (0.0, 0.0, 0.0)  # of the point on the road that it stands on
    waiting_point_enu_m: Place = (0.0, 0.0, 5.0)  # 5 m above the road; source report, section "Task"
    fence_radius_m: Positive = 3000.0  # horizontal, about the datum
    time_limit_s: Positive = 120.0
    disturbed_between_s: Range = (12.0, 20.0)  # a gust, outage or origin step begins; drawn


class Scenario(StrictModel):
    """One experiment; a seed makes it a run."""

    name: str
    description: str
    track: TrackConfig
    sensors: SensorsConfig
    camera: CameraConfig = CameraConfig()
    detector: Literal["camera", "model"] = (
        "camera"  # the noise model of `sensors.pattern`, or the camera if there is one
    )
    telemetry: Literal["vehicle", "none"] = "vehicle"  # none: it tells nothing at all, and has to be seen
    wind: WindConfig = WindConfig()
    link: LinkConfig = LinkConfig()
    vehicle: VehicleConfig = VehicleConfig()
    system: SystemConfig = SystemConfig()
    firmware: FirmwareName = "px4"
    run: RunConfig = RunConfig()

    def with_run(self, **changes: Any) -> "Scenario":
        """Return the scenario with changes of its `run`."""
        return self.model_copy(update={"run": self.run.model_copy(update=changes)})

    @property
    def has_camera(self) -> bool:
        """Whether the pad is seen in rendered frames."""
        return self.camera.sees and self.detector == "camera"

    @property
    def is_silent(self) -> bool:
        """Whether the vehicle tells nothing of itself."""
        return self.telemetry == "none"
