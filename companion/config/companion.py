"""The companion's configuration: one TOML file, validated once, every value with its unit and source."""

from typing import Annotated, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from companion.config.autopilot import AutopilotConfig, GroundStationConfig, SetpointConfig
from companion.config.descent import DescentConfig
from companion.config.estimation import EstimatorConfig, EstimatorKind
from companion.config.integrity import IntegrityConfig
from companion.config.landing import AbortConfig, ChaseConfig, TakeoffConfig
from companion.config.planning import GuidanceConfig
from companion.config.sortie import SortieConfig
from companion.config.touchdown import TouchdownConfig
from companion.core.data import FlightLimits
from link.messages import PadGeometry
from link.program.toml_config import NotNegative, Positive, StrictModel

Speed = Annotated[float, Field(ge=0.1, le=1e4)]
Acceleration = Annotated[float, Field(ge=0.5, le=1e4)]
Jerk = Annotated[float, Field(ge=1.0, le=1e4)]
"""With less no drone is flown: the least of ArduPilot's WPNAV_SPEED_UP and _DN, WPNAV_ACCEL, and PSC_JERK_XY."""


class LimitsConfig(StrictModel):
    """What the planner may ask at most; the autopilot's own parameters can only lower it.

    The acceleration leaves half of a 45 degree tilt (9.8 m/s^2) to drag, wind and feedback.
    """

    speed_max_m_s: Speed = 30.0  # drag, 0.17 1/s by mass, takes half of a 45 degree tilt then
    climb_max_m_s: Speed = 3.0  # PX4 MPC_Z_VEL_MAX_UP
    descent_max_m_s: Speed = 1.5  # PX4 MPC_Z_VEL_MAX_DN
    acceleration_max_m_s2: Acceleration = 5.0
    vertical_acceleration_max_m_s2: Acceleration = 3.0  # upwards and downwards; PX4 MPC_ACC_DOWN_MAX, of its own modes
    jerk_max_m_s3: Jerk = 20.0
    vertical_jerk_max_m_s3: Jerk = 20.0
    range_max_m: Positive = 2000.0  # from the waiting point, where an abort begins; it ends v^2 / 4 + 2 v farther
    landing_time_s: Positive = 15.0  # from the chase's beginning to the pad, for the way that takes
    battery_min_share: Annotated[float, Field(ge=0.0, lt=1.0)] = 0.2  # below this no landing is begun

    def flight_limits(self) -> FlightLimits:
        """Return the planner's part of them."""
        names = FlightLimits.__struct_fields__
        return FlightLimits(**{name: value for name, value in self.model_dump().items() if name in names})


class SilentVehicleConfig(StrictModel):
    """A vehicle that tells nothing: what whoever flies knows of its pad, which only sightings place."""

    pad_size_m: tuple[Positive, Positive] = (1.5, 1.5)  # MBZIRC 2017, as is the height
    pad_height_m: NotNegative = 1.5  # above the road

    @property
    def pad(self) -> PadGeometry:
        """The pad as such a vehicle would tell it, whose reference point is the pad's centre."""
        return PadGeometry(size_m=self.pad_size_m, height_m=self.pad_height_m, antenna_to_pad_m=(0.0, 0.0, 0.0))


class RecordingConfig(StrictModel):
    """The recording of a flight; see docs/recording.md."""

    folder: str | None = None  # where it is written, none where there is no folder; `--record` stands above it
    file_max_mb: Positive = 256.0  # after which a new file is begun
    # Of all files in the folder, earlier starts' too; the oldest are deleted.
    total_max_mb: Annotated[float, Field(gt=0.0, le=1e6, validate_default=True)] = 2000.0

    @field_validator("total_max_mb")
    @classmethod
    def _has_room_for_a_file(cls, value: float, info: ValidationInfo) -> float:
        file_max_mb = info.data.get("file_max_mb")
        if file_max_mb is not None and value < file_max_mb:
            raise ValueError(f"it must be file_max_mb, {file_max_mb:g}, or more, for one file is always kept")
        return value


class FlightConfig(StrictModel):
    """What is flown from the take-off to the end, a table for each part."""

    limits: LimitsConfig = LimitsConfig()
    takeoff: TakeoffConfig = TakeoffConfig()
    chase: ChaseConfig = ChaseConfig()
    descent: DescentConfig = DescentConfig()
    touchdown: TouchdownConfig = TouchdownConfig()
    abort: AbortConfig = AbortConfig()
    sortie: SortieConfig = SortieConfig()


class CompanionConfig(FlightConfig):
    """Everything that can be set about the companion; its file has the tables of the flight beside its own."""

    # A vehicle without telemetry; none: the vehicle tells where it is, and how its pad lies on it.
    silent_vehicle: SilentVehicleConfig | None = None
    autopilot: AutopilotConfig = AutopilotConfig()
    setpoints: SetpointConfig = SetpointConfig()
    ground_station: GroundStationConfig = GroundStationConfig()
    integrity: IntegrityConfig = IntegrityConfig()
    estimator: EstimatorConfig = EstimatorConfig()
    guidance: GuidanceConfig = GuidanceConfig()
    recording: RecordingConfig = RecordingConfig()

    @model_validator(mode="after")
    def _can_start_from_sightings(self) -> Self:
        if self.silent_vehicle is not None and self.estimator.kind is not EstimatorKind.IMM:
            kind = self.estimator.kind.value
            raise ValueError(f"silent_vehicle needs estimator.kind 'imm', since '{kind}' starts on fixes only")
        return self
