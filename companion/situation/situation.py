"""The facts of one step that the phases decide on, put together from the estimate, the pad and the drone."""

import math

from msgspec import Struct, structs

from companion.autopilots.driver import AutopilotView
from companion.config.companion import CompanionConfig
from companion.config.landing import ChaseConfig
from companion.core.data import Array, FlightLimits, Quantity, Rival
from companion.planning.guidance import ReferenceState
from companion.vehicle.pad import PadPath
from link.messages import ContactForecast, Vector3
from link.records import replace


class Drone(Struct, frozen=True, kw_only=True, eq=False):
    """The drone now, carried forward from its last report.

    Attributes:
        position_enu_m: (3,) in W.
        velocity_enu_m_s: (3,) in W.
        yaw_rad: heading of B about W's z.
        age_s: of the report.
        acceleration_up_m_s2: from the last reports, None before there are enough.
        jolt_m_s2: size of the horizontal acceleration from the last reports, None before there are enough.
        lean: sine of its tilt.
        lean_rate_hz: by which that grows.
        attitude_known: no older than a report may be.
    """

    position_enu_m: Array
    velocity_enu_m_s: Array
    yaw_rad: float
    age_s: float
    acceleration_up_m_s2: float | None = None
    jolt_m_s2: float | None = None
    lean: float = 0.0
    lean_rate_hz: float = 0.0
    attitude_known: bool = True


class Approach(Struct, frozen=True, kw_only=True):
    """The drone against the pad: its feet from the pad's centre, in W and in four numbers."""

    position_enu_m: Vector3
    velocity_enu_m_s: Vector3
    distance_m: float  # horizontal
    speed_m_s: float  # horizontal
    height_m: float  # of the feet above the pad
    climb_m_s: float  # upwards against the pad
    pad_half_width_m: float = math.inf  # from its centre to its nearest edge


class VehicleNews(Struct, frozen=True, kw_only=True):
    """How what the vehicle sends comes, and how far it can be believed; None where that is not known.

    Attributes:
        fix_age_s: since the newest accepted fix was taken.
        fix_age_on_arrival_s: of the newest accepted fix when it was taken in.
        fixes_apart_s: by their stamps, of the newest ones; None of a single one.
        stamps_stepped_s: by how much its fixes come later after their stamps than before a clock was set; 0 without.
        fix_std_m: that the newest fix states horizontally.
        is_alive: its liveliness token is there; None when it never showed one.
        speed_std_m_s: of its horizontal velocity; infinite while that is not known.
        rejected_share: of its measurements of the last seconds, 0 to 1.
        rejected: the quantity that this is the share of; None of all together.
        is_pad_doubted: it describes another pad now than the one that is flown to.
        are_sightings_mixed: what the drone sees of the pad contradicts itself.
        is_pad_sighted: the estimate has taken sightings of the last seconds, however few and vague.
        has_unplaced_sightings: what lately came of its pad is stamped when nobody knew where the drone was.
        has_receiver_stepped: its place, or the drone's, has stepped or slid since its phases were fixed.
        has_pad_stepped: it is seen elsewhere on the vehicle than where it was confirmed.
        is_road_elsewhere: it is said to be higher or lower than any hill puts it.
        has_shown_heading: its course has agreed with its heading.
    """

    fix_age_s: float | None = None
    fix_age_on_arrival_s: float | None = None
    fixes_apart_s: float | None = None
    stamps_stepped_s: float = 0.0
    fix_std_m: float | None = None
    is_alive: bool | None = None
    speed_std_m_s: float = math.inf
    rejected_share: float = 0.0
    rejected: Quantity | None = None
    is_pad_doubted: bool = False
    are_sightings_mixed: bool = False
    is_pad_sighted: bool = False
    has_unplaced_sightings: bool = False
    has_receiver_stepped: bool = False
    has_pad_stepped: bool = False
    is_road_elsewhere: bool = False
    has_shown_heading: bool = True


class Below(Struct, frozen=True, kw_only=True, eq=False):
    """What is below the drone.

    Attributes:
        range_height_m: of the feet above what a range finder sees, None without a fresh reading.
        range_carried_m: the last such height less what the drone has sunk since, for it may be too near to be seen.
        ground_enu_m: (3,) where the drone stood, or what its range finder saw before the flight; None while not known.
    """

    range_height_m: float | None = None
    range_carried_m: float | None = None
    ground_enu_m: Array | None = None


class Following(Struct, frozen=True, kw_only=True):
    """How the drone follows its setpoints.

    Attributes:
        error_m: its distance from where it was asked to be at that time.
        error_max_m: of one that follows them as its autopilot does in gusts over this link.
        lost_for_s: for how long it has lost them again and again, though they began where it was.
        reference: the virtual model that they follow.
        late_s: after which most have come: the link's mean delay and its standard deviation.
        unanswered_s: for so long nothing has shown that the autopilot hears them.
        answering_s: how long ago it began to show that without a gap; None of one that never does.
        rides_m: the lowest foot above that of a level drone on the virtual model, when it could touch nothing.
        pushed_m_s2: horizontal thrust by mass that holds against the air, in a gust of three standard deviations.
        takes_m_s2: the same that a drone takes which stays above the pad, in this air.
    """

    error_m: float
    error_max_m: float
    lost_for_s: float = 0.0
    reference: ReferenceState | None = None
    late_s: float = 0.0
    unanswered_s: float = 0.0
    answering_s: float | None = None
    rides_m: float = 0.0
    pushed_m_s2: float = 0.0
    takes_m_s2: float = 0.0


class Situation(Struct, frozen=True, kw_only=True, eq=False):
    """What is known in this step; None where it is not.

    Attributes:
        t_ns: now, UTC.
        monotonic_ns: now, for spans of time.
        autopilot: as its messages tell.
        drone: now.
        pad: now and over the horizon.
        vehicle: how its data come.
        below: the drone.
        feet_offset_m: of the drone's reported position above its feet.
        following: how the drone follows its setpoints.
        waiting_point_enu_m: (3,) in W.
        limits: of the flight, the autopilot's own included.
        speed_limited_by: the autopilot's parameters that may bound the speed.
        rival: another companion that was there first, None without one.
        contact: the newest forecast of the contact that a committed descent leads to, None without one.
        approach: the drone against the pad, None unless both are known; follows from them.
    """

    t_ns: int
    monotonic_ns: int
    autopilot: AutopilotView
    drone: Drone | None
    pad: PadPath | None
    vehicle: VehicleNews
    below: Below
    feet_offset_m: float
    following: Following
    waiting_point_enu_m: Array | None
    limits: FlightLimits | None = None
    speed_limited_by: tuple[str, ...] = ()
    rival: Rival | None = None
    contact: ContactForecast | None = None
    approach: Approach | None = None

    def __post_init__(self) -> None:
        """Derive the approach, of a copy as well; what is given for it does not count."""
        approach = None
        if self.drone is not None and self.pad is not None:
            approach = _approach(self.drone, self.pad, self.feet_offset_m)
        structs.force_setattr(self, "approach", approach)


def _approach(drone: Drone, pad: PadPath, feet_offset_m: float) -> Approach:
    (x, y, z), (vx, vy, vz) = drone.position_enu_m.tolist(), drone.velocity_enu_m_s.tolist()
    (pad_x, pad_y, pad_z), (pad_vx, pad_vy, pad_vz) = pad.position_enu_m[0].tolist(), pad.velocity_enu_m_s[0].tolist()
    position = (x - pad_x, y - pad_y, z - feet_offset_m - pad_z)
    velocity = (vx - pad_vx, vy - pad_vy, vz - pad_vz)
    return Approach(
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        distance_m=math.hypot(position[0], position[1]),
        speed_m_s=math.hypot(velocity[0], velocity[1]),
        height_m=position[2],
        climb_m_s=velocity[2],
        pad_half_width_m=pad.half_width_m,
    )


def with_pad(situation: Situation, pad: PadPath | None) -> Situation:
    """Return the facts with another pad."""
    return replace(situation, pad=pad)


def vehicle_stands(situation: Situation, config: ChaseConfig) -> bool:
    """Return whether the vehicle is known and stands, as far as its speed is known."""
    if situation.pad is None:
        return False
    std_m_s = situation.vehicle.speed_std_m_s
    unsure_m_s = config.parked_speed_stds * std_m_s if math.isfinite(std_m_s) else 0.0
    return situation.pad.ground_speed_m_s < max(config.parked_speed_m_s, unsure_m_s)


def driving_hold_s(_: Situation, config: CompanionConfig) -> float:
    """Return for how long what is said of the vehicle's driving must be true: an estimate that has just begun jumps."""
    return config.chase.driving_hold_s
