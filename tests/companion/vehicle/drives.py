"""Vehicles that drive the benchmark's tracks, and what their sensors would say: plain arrays, seeded."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from companion.core.data import Array, Measurement, Quantity

TRUTH_STEP_S = 0.005
EPOCH_NS = 1_700_000_000_000_000_000
ANTENNA_TO_PAD_M = (-0.7, 0.1, 0.3)

Profile = Callable[[float], float]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Drive:
    """True motion of the antenna in W every `TRUTH_STEP_S`: (n, 3), (n, 3), (n,), (n,), and the road's grade (n,)."""

    position: Array
    velocity: Array
    yaw: Array
    yaw_rate: Array
    grade: Array

    def at(self, t_s: float) -> tuple[Array, Array, float, float]:
        where, rest = divmod(t_s / TRUTH_STEP_S, 1.0)
        i = int(min(max(where, 0), len(self.yaw) - 2))
        blend = [(1.0 - rest) * a[i] + rest * a[i + 1] for a in (self.position, self.velocity, self.yaw, self.yaw_rate)]
        return blend[0], blend[1], float(blend[2]), float(blend[3])

    def pad_at(self, t_s: float) -> Array:
        """The pad's centre (3,), by which the vehicle pitches with the grade."""
        position, _, yaw, _ = self.at(t_s)
        grade = float(np.interp(t_s, np.arange(len(self.grade)) * TRUTH_STEP_S, self.grade))
        return np.asarray(pad_centre(position, yaw) + np.array([0.0, 0.0, ANTENNA_TO_PAD_M[0] * grade]))

    @property
    def length_s(self) -> float:
        return (len(self.yaw) - 1) * TRUTH_STEP_S


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensors:
    """The benchmark's sensors of a vehicle; a rate of 0 means absent."""

    fix_std_m: float
    fix_bias_std_m: float = 0.0
    velocity_std_m_s: float = 0.0
    heading_std_rad: float = 0.0
    heading_bias_rad: float = 0.0
    yaw_rate_std_rad_s: float = 0.0
    rate_hz: float = 10.0
    delay_s: float = 0.06
    frame_offset_m: float = 0.0
    pad_rate_hz: float = 0.0
    pad_std_m: float = 0.05
    pad_delay_s: float = 0.06
    outage_s: tuple[float, float] = (math.inf, math.inf)


NOMINAL = Sensors(
    fix_std_m=0.02, velocity_std_m_s=0.05, heading_std_rad=math.radians(1.0), yaw_rate_std_rad_s=math.radians(0.5)
)
FIX_ONLY = Sensors(fix_std_m=0.02)
REPORT = Sensors(fix_std_m=0.1, rate_hz=100.0, delay_s=0.0)
DEGRADED = Sensors(fix_std_m=0.3, fix_bias_std_m=1.5, velocity_std_m_s=0.1, rate_hz=5.0, delay_s=0.2)


def drive(
    length_s: float, speed: Profile, curvature: Profile, height: Profile = lambda _: 0.0, *, pitches: bool = True
) -> Drive:
    """Integrate a vehicle whose pad starts at (30, -20) heading 0.3 rad, follows the road and pitches with it."""
    n = round(length_s / TRUTH_STEP_S) + 1
    t = np.arange(n) * TRUTH_STEP_S
    v = np.array([speed(s) for s in t])
    yaw_rate = v * np.array([curvature(s) for s in t])
    yaw = 0.3 + np.concatenate([[0.0], np.cumsum(0.5 * (yaw_rate[1:] + yaw_rate[:-1]) * TRUTH_STEP_S)])
    z = np.array([height(s) for s in t])
    road = np.column_stack([v * np.cos(yaw), v * np.sin(yaw)])
    xy = np.array([30.0, -20.0]) + np.vstack(
        [np.zeros(2), np.cumsum(0.5 * (road[1:] + road[:-1]) * TRUTH_STEP_S, axis=0)]
    )
    lever_x, lever_y, _ = ANTENNA_TO_PAD_M
    arm = np.column_stack(
        [np.cos(yaw) * lever_x - np.sin(yaw) * lever_y, np.sin(yaw) * lever_x + np.cos(yaw) * lever_y]
    )
    swing = yaw_rate[:, None] * np.column_stack([arm[:, 1], -arm[:, 0]])
    rise = np.gradient(z, TRUTH_STEP_S)
    grade = np.divide(rise, v, out=np.zeros(n), where=v > 0.0) if pitches else np.zeros(n)
    antenna_z = z + 1.8 - lever_x * grade
    position = np.column_stack([xy - arm, antenna_z])
    velocity = np.column_stack([road + swing, np.gradient(antenna_z, TRUTH_STEP_S)])
    return Drive(position=position, velocity=velocity, yaw=yaw, yaw_rate=yaw_rate, grade=grade)


def straight(speed_m_s: float, length_s: float = 20.0) -> Drive:
    return drive(length_s, lambda _: speed_m_s, lambda _: 0.0)


def circle(speed_m_s: float = 8.0, radius_m: float = 20.0, length_s: float = 20.0) -> Drive:
    return drive(length_s, lambda _: speed_m_s, lambda _: 1.0 / radius_m)


def figure_eight(speed_m_s: float = 7.0) -> Drive:
    """Two circles of r = 16.5 m, centres 46.6 m apart, joined by their crossing tangents."""
    around_s = 16.5 * (math.pi + 2.0 * math.asin(33.0 / 46.6)) / speed_m_s
    across_s = math.sqrt(46.6**2 - 33.0**2) / speed_m_s

    def curvature(t_s: float) -> float:
        lap, rest = divmod(t_s, around_s + across_s)
        if rest > around_s:
            return 0.0
        return (1.0 if lap % 2 == 0 else -1.0) / 16.5

    return drive(2.2 * (around_s + across_s), lambda _: speed_m_s, curvature)


def brake(speed_m_s: float = 10.0) -> Drive:
    return drive(14.0, lambda t: min(max(speed_m_s - 6.0 * (t - 10.0), 0.0), speed_m_s), lambda _: 0.0)


def stop_and_go() -> Drive:
    up_s, hold_s, down_s, stand_s = 7.0 / 1.5, 3.0, 7.0 / 3.0, 3.0

    def speed(t_s: float) -> float:
        rest = t_s % (up_s + hold_s + down_s + stand_s)
        return float(np.interp(rest, np.cumsum([0.0, up_s, hold_s, down_s]), [0.0, 7.0, 7.0, 0.0]))

    return drive(30.0, speed, lambda _: 0.0)


def random_drive(seed: int, speed_m_s: float = 7.0) -> Drive:
    """Ornstein-Uhlenbeck acceleration along and across, sigma 0.8 m/s^2, tau 3 s."""
    rng = np.random.default_rng(seed)
    n = round(20.0 / TRUTH_STEP_S) + 2
    fade = math.exp(-TRUTH_STEP_S / 3.0)
    a = np.zeros((n, 2))
    for i in range(1, n):
        a[i] = fade * a[i - 1] + 0.8 * math.sqrt(1.0 - fade**2) * rng.standard_normal(2)
    along, across = a.T
    v = np.maximum(speed_m_s + np.cumsum(along) * TRUTH_STEP_S, 1.0)
    t = np.arange(n) * TRUTH_STEP_S
    return drive(20.0, lambda s: float(np.interp(s, t, v)), lambda s: float(np.interp(s, t, across / v**2)))


def rough_road() -> Drive:
    def height(t_s: float) -> float:
        return 0.25 * t_s + 0.1 * math.sin(2 * math.pi * 0.7 * t_s)

    return drive(20.0, lambda _: 5.0, lambda _: 0.0, height, pitches=False)


def climb(grade: float, speed_m_s: float, *, from_s: float = 6.0, transition_m: float = 10.0) -> Drive:
    """A road whose grade sets in evenly over `transition_m`."""

    def height(t_s: float) -> float:
        along_m = speed_m_s * (t_s - from_s)
        if along_m <= 0.0:
            return 0.0
        if along_m < transition_m:
            return 0.5 * grade / transition_m * along_m**2
        return grade * (along_m - 0.5 * transition_m)

    return drive(from_s + transition_m / speed_m_s + 4.0, lambda _: speed_m_s, lambda _: 0.0, height)


def sense(truth: Drive, sensors: Sensors, seed: int) -> list[tuple[int, Measurement]]:
    """Return (arrival time, measurement) in order of arrival."""
    rng = np.random.default_rng(seed)
    offset = sensors.frame_offset_m * _direction(rng)
    arrivals = [*_vehicle_sensors(truth, sensors, offset, rng), *_pad_sightings(truth, sensors, rng)]
    return sorted(arrivals, key=lambda arrival: arrival[0])


def pad_centre(position: Array, yaw: float) -> Array:
    c, s = math.cos(yaw), math.sin(yaw)
    x, y, z = ANTENNA_TO_PAD_M
    return np.asarray(position + np.array([c * x - s * y, s * x + c * y, z]))


def _direction(rng: np.random.Generator) -> Array:
    direction = rng.standard_normal(3)
    return np.asarray(direction / np.linalg.norm(direction))


def _vehicle_sensors(
    truth: Drive, sensors: Sensors, offset: Array, rng: np.random.Generator
) -> Iterator[tuple[int, Measurement]]:
    dt = 1.0 / sensors.rate_hz
    fade = math.exp(-dt / 60.0)
    bias = sensors.fix_bias_std_m * rng.standard_normal(3)
    heading_bias_rad = sensors.heading_bias_rad
    fix_covariance = (sensors.fix_std_m**2 + sensors.fix_bias_std_m**2) * np.eye(3)
    for i in range(int(truth.length_s * sensors.rate_hz)):
        t = i * dt
        bias = fade * bias + sensors.fix_bias_std_m * math.sqrt(1.0 - fade**2) * rng.standard_normal(3)
        position, velocity, yaw, yaw_rate = truth.at(t)
        noise = rng.standard_normal(8)
        values = (
            (Quantity.POSITION, position + bias - offset + sensors.fix_std_m * noise[:3], fix_covariance),
            (Quantity.VELOCITY, velocity + sensors.velocity_std_m_s * noise[3:6], sensors.velocity_std_m_s),
            (
                Quantity.HEADING,
                np.array([math.remainder(yaw + heading_bias_rad + sensors.heading_std_rad * noise[6], math.tau)]),
                math.hypot(sensors.heading_std_rad, heading_bias_rad),
            ),
            (
                Quantity.YAW_RATE,
                np.array([yaw_rate + sensors.yaw_rate_std_rad_s * noise[7]]),
                sensors.yaw_rate_std_rad_s,
            ),
        )
        if sensors.outage_s[0] <= t < sensors.outage_s[1]:
            continue
        for quantity, value, spread in values:
            covariance = spread if isinstance(spread, np.ndarray) else spread**2 * np.eye(len(value))
            if covariance[0, 0] > 0.0:
                yield arrival(t, sensors.delay_s, quantity, value, covariance)


def _pad_sightings(truth: Drive, sensors: Sensors, rng: np.random.Generator) -> Iterator[tuple[int, Measurement]]:
    for i in range(int(truth.length_s * sensors.pad_rate_hz)):
        t = i / sensors.pad_rate_hz
        value = truth.pad_at(t) + sensors.pad_std_m * rng.standard_normal(3)
        yield arrival(t, sensors.pad_delay_s, Quantity.PAD, value, sensors.pad_std_m**2 * np.eye(3))


def arrival(t_s: float, delay_s: float, quantity: Quantity, value: Array, covariance: Array) -> tuple[int, Measurement]:
    t_ns = EPOCH_NS + round(t_s * 1e9)
    measurement = Measurement(t_ns=t_ns, quantity=quantity, value=value, covariance=covariance)
    return t_ns + round(delay_s * 1e9), measurement
