"""A PX4 as the companion's node meets it, in MAVLink bytes on a clock of its own, and the node beside it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache

from companion.config.companion import CompanionConfig
from companion.runtime.build import build_node
from companion.runtime.node import CompanionNode
from link.frames.geodesy import geodetic_from_local
from link.mavlink.dialect import Message, mavlink
from link.messages import Fix, Vector3
from link.payloads import cdr
from link.zenoh.keys import Keys
from tests.companion.world import FRAME, ORIGIN, PAD_HEIGHT_M
from tests.link.mavlink.fake_autopilot import MS, START_NS, UTC_AHEAD_NS, FakeAutopilot, S

OFFBOARD, POSITION = 0x0006_0000, 0x0003_0000
PLACE_1E7 = (475_555_555, 80_214_091)
KEYS = Keys()
TICK_NS = 5 * MS
_TICKS_A_FIX = 20
PLACE = (-30.0, 0.4, PAD_HEIGHT_M)
"""Of a vehicle that has not come yet."""


@cache
def _config() -> CompanionConfig:
    return CompanionConfig()


@dataclass
class FakePx4(FakeAutopilot):
    """Obeys modes and arming, hovers where it is told to be by `place_ned_m`."""

    armed: bool = False
    custom_mode: int = POSITION
    place_ned_m: Vector3 = (0.0, 0.0, -0.12)
    origin_altitude_m: float = ORIGIN.altitude_m
    geoid_height_m: float | None = 0.0  # None: its receiver does not tell it
    vehicle_type: int = mavlink.MAV_TYPE_QUADROTOR
    utc_set_by_ns: int = 0
    landed_state: int = mavlink.MAV_LANDED_STATE_ON_GROUND
    system_status: int = mavlink.MAV_STATE_ACTIVE
    now_ns: int = START_NS

    def message(self, message_id: int, t_ns: int) -> Message:
        builders = {
            mavlink.MAVLINK_MSG_ID_HEARTBEAT: self._heartbeat,
            mavlink.MAVLINK_MSG_ID_CURRENT_MODE: self._current_mode,
            mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE: self._landed_state,
            mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN: self._origin,
            mavlink.MAVLINK_MSG_ID_GPS_RAW_INT: self._receiver,
            mavlink.MAVLINK_MSG_ID_BATTERY_STATUS: self._battery,
            mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR: self._range,
        }
        if message_id in builders:
            return builders[message_id]()
        message = super().message(message_id, t_ns)
        if message_id == mavlink.MAVLINK_MSG_ID_SYSTEM_TIME:
            message.time_unix_usec += self.utc_set_by_ns // 1000
        elif message_id == mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED:
            message.x, message.y, message.z = self.place_ned_m
            message.vx, message.vy, message.vz = 0.0, 0.0, 0.0
        return message

    def _heartbeat(self) -> Message:
        base = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
        base |= mavlink.MAV_MODE_FLAG_SAFETY_ARMED if self.armed else 0
        return mavlink.MAVLink_heartbeat_message(
            self.vehicle_type, self.firmware, base, self.custom_mode, self.system_status, 3
        )

    def _current_mode(self) -> Message:
        return mavlink.MAVLink_current_mode_message(0, self.custom_mode, self.custom_mode)

    def _landed_state(self) -> Message:
        return mavlink.MAVLink_extended_sys_state_message(0, self.landed_state)

    def _origin(self) -> Message:
        return mavlink.MAVLink_gps_global_origin_message(*PLACE_1E7, round(self.origin_altitude_m * 1e3))

    def _receiver(self) -> Message:
        msl_mm = round(self.origin_altitude_m * 1e3)
        ellipsoid_mm = 0 if self.geoid_height_m is None else msl_mm + round(self.geoid_height_m * 1e3)
        return mavlink.MAVLink_gps_raw_int_message(0, 3, *PLACE_1E7, msl_mm, 70, 110, 0, 0, 10, ellipsoid_mm)

    def _battery(self) -> Message:
        return mavlink.MAVLink_battery_status_message(0, 0, 0, 2500, [0] * 10, -1, -1, -1, 80)

    def _range(self) -> Message:
        down = mavlink.MAV_SENSOR_ROTATION_PITCH_270
        return mavlink.MAVLink_distance_sensor_message(0, 20, 1200, round(-self.place_ned_m[2] * 100.0), 0, 0, down, 0)

    def obey(self, message: Message) -> None:
        super().obey(message)
        self.intervals_ns = {one: period_ns for one, period_ns in self.intervals_ns.items() if period_ns > 0}
        if self.results.get(message.command, (0,)) != (0,):
            return
        match message.command:
            case mavlink.MAV_CMD_DO_SET_MODE:
                self.custom_mode = int(message.param2) << 16 | int(message.param3) << 24
            case mavlink.MAV_CMD_COMPONENT_ARM_DISARM:
                self.armed = message.param1 == 1.0
            case mavlink.MAV_CMD_REQUEST_MESSAGE:
                self.send(self.message(int(message.param1), self.now_ns))

    def tick(self, t_ns: int) -> None:
        self.now_ns = t_ns
        super().tick(t_ns)

    def setpoints(self) -> list[Message]:
        return self.of_type("SET_POSITION_TARGET_LOCAL_NED")

    def commands(self, command: int) -> list[Message]:
        return [message for message in self.of_type("COMMAND_LONG") if message.command == command]


@dataclass
class Setup:
    """A node and its autopilot on a perfect link; `utc_ns` is what time it is in the world."""

    autopilot: FakePx4 = field(default_factory=FakePx4)
    dry_run: bool = False
    publishes: bool = True
    is_component: bool = False
    t_ns: int = START_NS
    config: CompanionConfig = field(default_factory=_config)

    def __post_init__(self) -> None:
        self.node: CompanionNode = build_node(
            self.config, KEYS, dry_run=self.dry_run, publishes=self.publishes, is_component=self.is_component
        )

    @property
    def utc_ns(self) -> int:
        return self.t_ns + UTC_AHEAD_NS + self.autopilot.utc_set_by_ns

    def run(self, duration_s: float, each_tick: Callable[[], None] = lambda: None) -> None:
        for _ in range(round(duration_s * S / TICK_NS)):
            self.t_ns += TICK_NS
            self.autopilot.tick(self.t_ns)
            for data in self.autopilot.take_output():
                self.node.receive_mavlink(data, self.t_ns)
            each_tick()
            self.node.poll(self.t_ns)
            for frame in self.node.take_frames():
                self.autopilot.receive(frame, self.t_ns)

    def fixes(self, place_enu_m: Vector3 = PLACE, std_m: float = 0.0) -> None:
        """Send a fix as `fix` does, in every twentieth tick: ten a second, as receivers do."""
        if self.t_ns // TICK_NS % _TICKS_A_FIX == 0:
            self.fix(place_enu_m, std_m=std_m)

    def fix(self, place_enu_m: Vector3 = PLACE, late_s: float = 0.0, std_m: float = 0.0) -> None:
        """Send a fix of a vehicle, made `late_s` ago; without a deviation it states none."""
        frame = self.node.autopilot.state.view.frame or FRAME
        latitude_rad, longitude_rad, altitude_m = geodetic_from_local(frame, place_enu_m)
        message = Fix(
            t_ns=self.utc_ns - round(late_s * 1e9),
            latitude_rad=latitude_rad,
            longitude_rad=longitude_rad,
            altitude_m=altitude_m,
            covariance_enu_m2=(std_m**2, 0.0, 0.0, 0.0, std_m**2, 0.0, 0.0, 0.0, std_m**2) if std_m else None,
        )
        self.node.receive_sample(KEYS.fix, cdr.encode(message))
