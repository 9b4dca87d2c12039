"""An autopilot on the vehicle, such as a rover's, as its receiver: GPS_RAW_INT and the attitude.

GPS_RAW_INT is where the antenna is, with the receiver's own accuracy; the autopilot's estimate (GLOBAL_POSITION_INT)
would be of the autopilot's place and says nothing of its accuracy. Stamps since boot become UTC by SYSTEM_TIME, whose
UTC is the receiver's. Without a double antenna the heading is the autopilot's attitude, of unknown accuracy.
Source: MAVLink common messages.
"""

from math import radians

from link.frames.rotations import flu_from_frd, normalized, quaternion_enu_flu_from_ned_frd
from link.mavlink.clock_map import UNIX_TIME_MIN_NS
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import LinkFound, MessageReceived
from link.mavlink.session import MavlinkSession
from link.messages import Fix, FixVelocity, VehicleImu
from scenarios.vehicle_sources.receiver import (
    Reading,
    are_positive,
    course_velocity,
    diagonal,
    heading_imu,
    is_repeated,
)

_STREAMS_HZ = {
    mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: 20.0,  # more than receivers have; a doubled one is passed over
    mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: 2.0,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION: 20.0,
}
_UNKNOWN_U16 = 65535
_NORTH_CDEG = 36000  # of a yaw, where 0 says that there is none
_OWN_SYSTEM_ID = 1

# The message has none. An autopilot levels itself by an accelerometer that is off by 0.2 m/s^2 (Bosch BMI088), a
# fiftieth of gravity, and turns itself by a compass that is off by 6 degrees.
_ATTITUDE_COVARIANCE_RAD2 = (4e-4, 0.0, 0.0, 0.0, 4e-4, 0.0, 0.0, 0.0, 1e-2)


class MavlinkReceiver:
    """An autopilot's receiver, heard over MAVLink."""

    def __init__(self) -> None:
        self._session = MavlinkSession(_OWN_SYSTEM_ID)
        self._without_place = 0
        self._reason: str | None = "no autopilot's heartbeat was received: check device, port and baud rate"
        self._told_ns = 0  # as it was stamped: UTC of the same stamp changes with what is known of the clocks
        self._has_double_antenna = False

    @property
    def complaint(self) -> str | None:
        """Why there are no fixes."""
        return self._reason

    @property
    def counts(self) -> dict[str, int]:
        """What was received."""
        codec = self._session.statistics.codec
        return {"messages": codec.messages_received, "bad": codec.bad_frames, "without_place": self._without_place}

    def connected(self) -> None:
        """Go on: the session asks again for what stays away."""

    def to_send(self, t_ns: int) -> bytes:
        """Return heartbeats and requests that are due."""
        self._session.poll(t_ns)
        return b"".join(self._session.take_output())

    def take(self, data: bytes, t_ns: int) -> list[Reading]:
        """Return what the messages completed by `data` tell."""
        readings: list[Reading] = []
        for event in self._session.receive(data, t_ns):
            if isinstance(event, LinkFound):
                self._reason = "the autopilot sends no GPS_RAW_INT"
                for message_id, rate_hz in _STREAMS_HZ.items():
                    self._session.request_interval(message_id, rate_hz, t_ns)
            elif isinstance(event, MessageReceived):
                readings += self._read(event.message)
        return readings

    def _read(self, message: Message) -> list[Reading]:
        match message.get_msgId():
            case mavlink.MAVLINK_MSG_ID_GPS_RAW_INT:
                return self._position(message)
            case mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION if not self._has_double_antenna and self._told_ns:
                t_ns = self._utc_ns(message.time_boot_ms * 10**6)
                return [] if t_ns is None else attitude_reading(message, t_ns)
            case _:
                return []

    def _utc_ns(self, stamp_ns: int) -> int | None:
        """Return UTC of a stamp, which is UTC already or time since boot; None while UTC is not known."""
        if stamp_ns >= UNIX_TIME_MIN_NS:
            return stamp_ns
        clock = self._session.clock
        return clock.boot_to_utc_ns(stamp_ns) if clock.is_utc_known else None

    def _position(self, message: Message) -> list[Reading]:
        if message.fix_type < mavlink.GPS_FIX_TYPE_3D_FIX:
            return self._miss("the autopilot's receiver has no fix: give it a view of the sky")
        if not message.alt_ellipsoid:
            return self._miss("the autopilot's receiver says no height above the ellipsoid (alt_ellipsoid)")
        stamp_ns = message.time_usec * 1000
        t_ns = self._utc_ns(stamp_ns)
        if t_ns is None:
            return self._miss("the autopilot does not say the UTC time (SYSTEM_TIME)")
        if is_repeated(stamp_ns, self._told_ns):
            return []
        self._told_ns, self._reason = stamp_ns, None
        found = (fix_of(message, t_ns), velocity_of(message, t_ns), heading_of(message, t_ns))
        self._has_double_antenna = found[2] is not None
        return [reading for reading in found if reading is not None]

    def _miss(self, reason: str) -> list[Reading]:
        self._without_place += 1
        self._reason = reason
        return []


def fix_of(message: Message, t_ns: int) -> Fix:
    """Return the position of a GPS_RAW_INT."""
    horizontal_m, vertical_m = message.h_acc * 1e-3, message.v_acc * 1e-3
    is_known = are_positive((horizontal_m, vertical_m))
    return Fix(
        t_ns=t_ns,
        latitude_rad=radians(message.lat * 1e-7),
        longitude_rad=radians(message.lon * 1e-7),
        altitude_m=message.alt_ellipsoid * 1e-3,
        covariance_enu_m2=diagonal(horizontal_m, horizontal_m, vertical_m) if is_known else None,
    )


def velocity_of(message: Message, t_ns: int) -> FixVelocity | None:
    """Return the velocity over ground of a GPS_RAW_INT, None when it has none."""
    if _UNKNOWN_U16 in (message.vel, message.cog):
        return None
    return course_velocity(
        t_ns,
        message.vel * 1e-2,
        radians(message.cog * 1e-2),
        speed_std_m_s=message.vel_acc * 1e-3 or None,
    )


def heading_of(message: Message, t_ns: int) -> VehicleImu | None:
    """Return the heading that a double antenna measures, None where there is none."""
    if not 0 < message.yaw <= _NORTH_CDEG:
        return None
    return heading_imu(t_ns, radians(message.yaw * 1e-2), radians(message.hdg_acc * 1e-5) or None)


def attitude_reading(message: Message, t_ns: int) -> list[Reading]:
    """Return attitude and rates of an ATTITUDE_QUATERNION, nothing when it is none."""
    try:
        q = normalized((message.q1, message.q2, message.q3, message.q4))
    except ValueError:
        return []
    rates = flu_from_frd((message.rollspeed, message.pitchspeed, message.yawspeed))
    return [
        VehicleImu(
            t_ns=t_ns,
            orientation_wxyz=quaternion_enu_flu_from_ned_frd(q),
            orientation_covariance_rad2=_ATTITUDE_COVARIANCE_RAD2,
            angular_velocity_flu_rad_s=rates,
        )
    ]
