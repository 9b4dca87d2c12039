"""The estimators' numbers, each with its unit in its name and where it comes from.

"Measured" stands for: chosen by the root mean square error over the benchmark's tracks with its `nominal` and
`degraded` sensors, as `tests/companion/vehicle/drives.py` simulates them.
"""

from enum import Enum
from typing import Annotated, Self

from pydantic import Field, model_validator

from link.program.toml_config import NotNegative, Positive, StrictModel


class EstimatorKind(Enum):
    """Which estimator of the ground vehicle is used."""

    LKF_REPORT = "lkf_report"  # the source report's linear filter with its own numbers
    LKF = "lkf"  # the same model with white jerk, velocity and the sensors' own covariances
    UKF = "ukf"  # car-like, after Baca et al. 2019
    IMM = "imm"  # interacting turning models, with the offset between the receivers' frames


class BufferConfig(StrictModel):
    """How late a measurement may come and when it is an outlier."""

    keep_s: Positive = 1.5  # three times the slowest link of the benchmark (300 ms + 200 ms)
    # wide, 58 for three components: an emergency brake is no outlier; None gates nothing
    gate_probability: Annotated[float, Field(gt=0.5, lt=1.0)] | None = 0.999999999999
    recover_after_s: Positive = 0.15  # of nothing but rejections of one quantity; the second fix at 10 Hz
    # What a filter knows of a vehicle that has been silent for so long is worth nothing, and costs more in every step.
    forget_after_s: Annotated[float, Field(gt=0.0, le=600.0)] = 60.0
    late_in_a_row_max: Annotated[int, Field(ge=1, le=10_000)] = 20  # places; then the clock is taken to have jumped


class LkfConfig(StrictModel):
    """The linear filter with constant acceleration per axis."""

    jerk_psd_m2_s5: Positive = 6.0  # white jerk, per horizontal axis; measured
    vertical_jerk_psd_m2_s5: Positive = 1.0  # measured
    initial_speed_std_m_s: Positive = 15.0  # at the first fix; two of them are `limits.speed_max_m_s`
    initial_acceleration_std_m_s2: Positive = 3.0  # at the first fix; two of them are a brake of 6 m/s^2


class LkfReportConfig(StrictModel):
    """The source report's numbers, "Ground vehicle and its estimate"."""

    step_s: Positive = 0.01
    step_variance: Positive = 0.01  # of every state, per step; m^2, m^2/s^2, m^2/s^4
    fix_variance_m2: Positive = 0.01
    initial_variance: Positive = 10.0


class UkfConfig(StrictModel):
    """The car-like filter."""

    jerk_psd_m2_s5: Positive = 5.0  # along the track; measured
    lateral_acceleration_psd_m2_s5: Positive = 3.0  # drives the curvature, by v^2; measured
    curvature_speed_min_m_s: Positive = 3.0  # below it the curvature's noise grows no further
    heading_psd_rad2_s: NotNegative = 1e-4  # side slip, scaled by speed; 0.6 degrees in 1 s
    vertical_acceleration_psd_m2_s3: Positive = 0.3  # measured
    acceleration_decay_s: Positive = 3.0  # of the mean in predictions; measured
    heading_known_speed_m_s: Positive = 1.0  # from which the course is the heading, as in `imm.heading`
    curvature_std_rad_m: Positive = 0.1  # at the start; a car's tightest turn is some 0.2


class SteadyConfig(StrictModel):
    """How a vehicle drives that does nothing new: the first of the interacting models."""

    # Of an ordinary driver: no other pair of numbers is likelier by more than 0.01 for what the vehicles of 40 drawn
    # worlds did (docs/notebook.md). Who is less steady is told from how he drives (`vehicle/steady_driving.py`).
    jerk_psd_m2_s5: Positive = 0.1
    lateral_acceleration_psd_m2_s5: Positive = 0.1  # drives the curvature, by v^2
    # The change of the grade in vertical curves of streets: the root mean square of 1 % in K for the least K of crests
    # (2, 4, 7, 11 m) and sags (6, 9, 13, 18 m) for 30 to 60 km/h (AASHTO Green Book 2011, 3.4.6). Faster roads bend
    # less: sags are made for the comfort of 0.3 m/s^2.
    bend_std_per_m: Positive = 0.002
    bend_acceleration_std_m_s2: Positive = 0.3
    begins_after_s: Positive = 0.4  # mean time after which anything else is over; not how long this one lasts


class EasingConfig(StrictModel):
    """A model that differs from the steady one by a pedal that is eased or touched."""

    jerk_psd_m2_s5: Positive = 10.0  # 1.5 m/s^2 within a quarter of a second, 1.5^2 / 0.25 s
    begins_after_s: Positive = 10.0  # in traffic every 9 s (`forecast/drivers.py`)


class BrakingConfig(StrictModel):
    """A model that differs from the steady one by a brake."""

    jerk_psd_m2_s5: Positive = 300.0  # 6 m/s^2 that are there within one period of a 10 Hz receiver, 6^2 / 0.1 s
    # So rare that fixes of 0.1 m at 100 Hz leave little noise, while a brake seen through them is found 0.1 s later;
    # measured.
    begins_after_s: Positive = 40.0


class TurningConfig(StrictModel):
    """A model that differs from the steady one by how the vehicle is steered."""

    lateral_acceleration_psd_m2_s5: Positive = 80.0  # a swerve of 4 m/s^2 that is there within 0.2 s, 4^2 / 0.2 s
    begins_after_s: Positive = 40.0  # as rare as a hard brake


class RampConfig(StrictModel):
    """A model that differs from the steady one by how the road bends upwards or down."""

    bend_std_per_m: Positive = 0.012  # 12 % within 10 m, as where a drive meets a street
    bend_acceleration_std_m_s2: Positive = 2.0  # 0.2 g, with which such are taken
    begins_after_s: Positive = 40.0  # as rare as a hard brake


class OscillatorConfig(StrictModel):
    """A damped oscillator that noise drives to a standard deviation, in m or rad."""

    std: Positive
    frequency_hz: Positive
    damping: Annotated[float, Field(gt=0.0, lt=1.0)]


class SwingConfig(StrictModel):
    """How a deck moves that nobody has watched yet; roll and pitch once the vehicle tells them."""

    heave: OscillatorConfig
    tilt: OscillatorConfig  # roll and pitch
    lag_s: Positive  # over which the motion is compared with itself to learn it: a tenth of a period or so


class SwayConfig(StrictModel):
    """How the body of a vehicle on wheels sways that does not tell its tilt, and that nobody has watched yet."""

    tilt_std_rad: Positive = 0.002  # 5 mm of height from axle to axle: on smooth asphalt
    heave_std_m: Positive = 0.005  # up and down, on smooth asphalt
    frequency_hz: Positive = 1.5  # at which bodies pitch and roll on their wheels (Gillespie 1992, chapter 5)
    # Of the softest springs, and of a road whose waves sway a body themselves. What is slower than 0.25 Hz does not
    # show in the 8 s for which an antenna is watched.
    frequency_min_hz: Annotated[float, Field(ge=0.25)] = 0.6
    damping: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.3  # of the critical one; dampers have 0.2 to 0.4
    prior_s: Positive = 5.0  # for which this counts as watched: some swings

    @model_validator(mode="after")
    def _is_slowest_below_first(self) -> Self:
        if self.frequency_min_hz > self.frequency_hz:
            raise ValueError(f"frequency_min_hz must not be above frequency_hz, {self.frequency_hz:g}")
        return self


class HeadingConfig(StrictModel):
    """How the vehicle turns, and where it points."""

    curvature_speed_min_m_s: Positive = 3.0  # below it the curvature's noise grows no further
    psd_rad2_s: Positive = 1e-4  # side slip; 0.6 degrees in 1 s
    course_std_rad: Positive = 0.3  # side slip of 3 degrees that lasts 5 s, as white noise at 10 Hz
    # From which the course tells the heading: 0.1 m/s of error are 0.1 rad then, as of a low-cost attitude sensor.
    course_speed_min_m_s: Positive = 1.0
    known_std_rad: Positive = 0.5  # worse than this the heading is not told
    unit_error_time_s: Positive = 60.0  # for which a told heading is off alike: by iron and steel beside the road
    curvature_std_rad_m: Positive = 0.1  # at the start; a car's tightest turn is some 0.2
    # Of drivers in curves, 0.2 g: streets for 30 to 60 km/h are built with side frictions of 0.28 to 0.17 (AASHTO 2011,
    # table 3-7). For the forecast of a vehicle of which only sightings tell.
    turning_std_m_s2: Positive = 2.0


class RoadConfig(StrictModel):
    """The road's grade, its bends and its roughness."""

    grade_std: Positive = 0.06  # at the start; 12 % is steep for a street
    bend_length_m: Positive = 10.0  # vertical curves are as long and longer
    height_psd_m2_m: NotNegative = 1e-5  # of the height, as ISO 8608 has it for a road of class B (waviness 2)
    # What gravity adds to an accelerometer along the vehicle: that of the grade above, for as long as 50 m of one grade
    # last at 10 m/s. A sensor's own offset is less (Bosch BMI088: 0.2 m/s^2).
    gravity_leak_std_m_s2: Positive = 0.6
    gravity_leak_time_s: Positive = 5.0


class ReceiversConfig(StrictModel):
    """The errors of the vehicle's and the drone's receivers, and of the clock that dates the vehicle's fixes."""

    # Between the two receivers' frames: ETRS89 has moved 2.5 cm a year against WGS 84 since 1989, 0.9 m by 2026.
    frame_offset_std_m: NotNegative = 1.0
    frame_offset_walk_m2_s: NotNegative = 1e-5
    fix_white_std_max_m: Positive = 0.3  # what a fix states beyond this is slow (Gauss-Markov) error; benchmark
    fix_bias_time_s: Positive = 60.0  # its time constant; benchmark
    # A drone over a vehicle without corrections has none either: its own place wanders by so much of the same
    # variance in a second. Benchmark: 0.5 m, of which 0.36 m are new after 10 s.
    own_walk_share: NotNegative = 0.13
    # Its height wanders over any vehicle, with a rate that lasts a while. With PX4 it moved by 0.09 m in 1 s, 0.27 m in
    # 4 s and 0.41 m in 8 s, a rate of 0.1 m/s (docs/real_autopilots.md); with corrections by next to nothing: root mean
    # square of the two.
    own_height_rate_std_m_s: NotNegative = 0.07
    # For which such a rate lasts. What it was in one second tells next to nothing of the height 8 s later: that comes
    # back to where it was.
    own_height_rate_time_s: Positive = 2.0
    own_height_time_s: Positive = 10.0  # after which a height that nothing tells is as wrong as it ever gets
    # Of the clock that dates such coarse fixes, against the drone's; benchmark: up to 0.1 s. Receivers with corrections
    # date their fixes themselves, to microseconds.
    clock_std_s: NotNegative = 0.03
    clock_time_s: Positive = 180.0  # in which it may become another; also what a wrong lever arm taught is forgotten


class ImmConfig(StrictModel):
    """Turning models of steady driving and of what interrupts it: a pedal, a brake, the wheel, a ramp."""

    steady: SteadyConfig = SteadyConfig()
    easing: EasingConfig = EasingConfig()
    braking: BrakingConfig = BrakingConfig()
    turning: TurningConfig = TurningConfig()
    ramp: RampConfig = RampConfig()
    # Of a vessel's lateral acceleration while it is steered evenly, in place of `steady`'s. With 10 degrees of rudder a
    # ship turns by 10 degrees within 2.5 lengths (IMO MSC.137(76), 5.3.2), faster and faster: one of 20 m at 6 m/s
    # changes that acceleration by 0.03 m/s^2 in each of 8 s.
    helm_psd_m2_s5: Positive = 0.007
    side_jerk_psd_m2_s5: Positive = 0.005  # across the track, apart from turning; measured
    acceleration_decay_s: Positive = 3.0  # measured
    initial_speed_std_m_s: Positive = 15.0  # at the first fix; two of them are `limits.speed_max_m_s`
    initial_acceleration_std_m_s2: Positive = 3.0  # at the first fix; two of them are a brake of 6 m/s^2
    heading: HeadingConfig = HeadingConfig()
    road: RoadConfig = RoadConfig()
    sway: SwayConfig = SwayConfig()
    # Waves shorter than 50 m of an unmade road, class E of ISO 8608, have a standard deviation of 0.03 to 0.06 m. The
    # heave rate of a body on them is white up to its bounce at 1.5 Hz (Gillespie 1992, chapter 5): half of that.
    on_road: SwingConfig = SwingConfig(
        heave=OscillatorConfig(std=0.04, frequency_hz=0.75, damping=0.3),
        tilt=OscillatorConfig(std=0.03, frequency_hz=1.0, damping=0.3),
        lag_s=0.1,
    )
    # Sea state 5 in STANAG 4194: 3.25 m of significant height, four standard deviations, with 9.7 s; a ship tilts by
    # the slope of such waves at most.
    afloat: SwingConfig = SwingConfig(
        heave=OscillatorConfig(std=0.8, frequency_hz=0.1, damping=0.2),
        tilt=OscillatorConfig(std=0.03, frequency_hz=0.1, damping=0.2),
        lag_s=0.5,
    )
    receivers: ReceiversConfig = ReceiversConfig()


class EstimatorConfig(StrictModel):
    """Everything that can be set about the estimator."""

    kind: EstimatorKind = EstimatorKind.IMM
    buffer: BufferConfig = BufferConfig()
    lkf: LkfConfig = LkfConfig()
    lkf_report: LkfReportConfig = LkfReportConfig()
    ukf: UkfConfig = UkfConfig()
    imm: ImmConfig = ImmConfig()
