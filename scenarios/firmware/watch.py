"""A second link to a firmware's own simulation: its clock, its truth, and its ship. Without I/O."""

from link.errors import UserError
from link.frames.geodesy import Datum, geodetic_from_enu
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import LinkFound, MessageReceived
from link.mavlink.session import MavlinkSession
from link.messages import BodyTruth, RotorTruth, Vector3
from link.records import replace
from scenarios.firmware.ship import ShipReport, ship_report
from scenarios.firmware.truth import (
    DATED_BY,
    TRUTH_STREAMS_HZ,
    TruePose,
    body_truth,
    motors_armed,
    rotor_truth,
    true_pose,
)
from sim_autopilot.physics.contact import GEAR_HEIGHT_M

_SYSTEM_ID = 245  # of this observer
_GROUND_M = 0.005  # the drone stands this much below the datum, so that standing is touching in spite of rounding
_CLOCK_HZ = 2.0
_GPS_HZ = 1.0


class FirmwareWatch:
    """What the simulation says of itself.

    Attributes:
        session: to the autopilot.
        drone: its newest truth about the datum, None before there is one.
        ship: the ship's newest report, None before there is one.
        truths: not yet taken.
    """

    def __init__(self) -> None:
        self.session = MavlinkSession(_SYSTEM_ID)
        self.drone: BodyTruth | None = None
        self.ship: ShipReport | None = None
        self.truths: list[BodyTruth | RotorTruth] = []
        self._others = MavlinkCodec(_SYSTEM_ID, 0)
        self._datum_msl: Datum | None = None
        self._geoid_height_m: float | None = None
        self._sent_boot_ns: dict[str, int] = {}

    @property
    def datum(self) -> Datum | None:
        """Where the drone stood when it was first seen, above the ellipsoid; None until all of that is known."""
        if self._datum_msl is None or self._geoid_height_m is None:
            return None
        return replace(self._datum_msl, altitude_m=self._datum_msl.altitude_m + self._geoid_height_m)

    def let_it_stand_at(self, position_enu_m: Vector3) -> Datum:
        """Move W so that the place where the drone stood first has these coordinates, and return its origin.

        Raises:
            ValueError: it has not been seen.
        """
        if self._datum_msl is None or self._geoid_height_m is None:
            raise ValueError("no drone is seen yet")
        east_m, north_m, up_m = position_enu_m
        latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(self._datum_msl, (-east_m, -north_m, -up_m))
        self._datum_msl = Datum(latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=altitude_m)
        self.drone, self.truths = None, []
        return replace(self._datum_msl, altitude_m=altitude_m + self._geoid_height_m)

    def utc_ns(self, local_ns: int) -> int | None:
        """Return the autopilot's UTC, None until it is known."""
        clock = self.session.clock
        return clock.local_to_utc_ns(local_ns) if clock.is_utc_known and clock.local_to_boot is not None else None

    def receive(self, data: bytes, local_ns: int, *, is_datagram: bool = False) -> None:
        """Take bytes of the link.

        Raises:
            UserError: the autopilot is of a kind whose simulation tells no truth.
        """
        for event in self.session.receive(data, local_ns, is_datagram=is_datagram):
            match event:
                case LinkFound():
                    self._ask_for_streams(event.autopilot, local_ns)
                case MessageReceived():
                    self._hear(event, local_ns)
                case _:
                    pass
        for message in self._others.decode(data, t_ns=local_ns, is_datagram=is_datagram):
            self.ship = ship_report(message) or self.ship

    def set_parameter(self, name: str, value: float) -> None:
        """Set one of ArduPilot's parameters."""
        target = self.session.target_system_id or 0
        kind = mavlink.MAV_PARAM_TYPE_REAL32
        self.session.send(mavlink.MAVLink_param_set_message(target, 1, name.encode("ascii"), value, kind))

    def take_truths(self) -> list[BodyTruth | RotorTruth]:
        """Return what has come since the last call."""
        taken, self.truths = self.truths, []
        return taken

    def _ask_for_streams(self, autopilot: int, local_ns: int) -> None:
        if autopilot not in TRUTH_STREAMS_HZ:
            raise UserError(f"MAV_AUTOPILOT {autopilot} tells no truth: watch a simulated PX4 or ArduPilot")
        common = {mavlink.MAVLINK_MSG_ID_SYSTEM_TIME: _CLOCK_HZ, mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: _GPS_HZ}
        for message_id, rate_hz in (TRUTH_STREAMS_HZ[autopilot] | common).items():
            self.session.request_interval(message_id, rate_hz, local_ns)

    def _hear(self, event: MessageReceived, local_ns: int) -> None:
        message, t_ns = event.message, self.utc_ns(local_ns)
        if message.get_type() == "GPS_RAW_INT" and message.fix_type >= mavlink.GPS_FIX_TYPE_3D_FIX:
            above_m = (message.alt_ellipsoid - message.alt) * 1e-3 if message.alt_ellipsoid else 0.0
            self._geoid_height_m = above_m if self._geoid_height_m is None else self._geoid_height_m
        armed = motors_armed(message)
        if t_ns is None:
            return
        if armed is not None:
            self.truths.append(rotor_truth(t_ns, armed=armed))
        if message.get_type() in DATED_BY.values():
            self._sent_boot_ns[message.get_type()] = message.time_boot_ms * 1_000_000
        pose = true_pose(message)
        if pose is not None and self._geoid_height_m is not None:
            self._see(pose, self._date_ns(message, t_ns))

    def _date_ns(self, message: Message, arrived_ns: int) -> int:
        """Return when a truth was sent, by the message sent with it; its arrival while there is none."""
        boot_ns = self._sent_boot_ns.pop(DATED_BY.get(message.get_type(), ""), None)
        sent_ns = None if boot_ns is None else self.session.clock.boot_to_utc_ns(boot_ns)
        return arrived_ns if sent_ns is None else sent_ns

    def _see(self, pose: TruePose, t_ns: int) -> None:
        if self._datum_msl is None:
            self._datum_msl = Datum(
                latitude_rad=pose.latitude_rad,
                longitude_rad=pose.longitude_rad,
                altitude_m=pose.altitude_m + _GROUND_M,
            )
        truth = body_truth(pose, self._datum_msl, t_ns, GEAR_HEIGHT_M)
        if self.drone is None or truth.t_ns > self.drone.t_ns:
            self.drone = truth
            self.truths.append(truth)
