"""The companion as a component: what a ground station that the autopilot passes on may ask, and hears."""

import math
from dataclasses import dataclass, field

import pytest

from companion.config.autopilot import GroundStationConfig, PadOnMap
from companion.config.companion import CompanionConfig
from companion.situation.phases import Phase
from link.frames.geodesy import Datum
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import DRAFT_MESSAGES, MAV_RESULT_CANCELLED, Message, mavlink
from link.messages import Command, CommandReply, PadGeometry
from tests.companion.peer import Setup
from tests.companion.world import FRAME

START, HOLD, ABORT = mavlink.MAV_CMD_USER_1, mavlink.MAV_CMD_USER_2, mavlink.MAV_CMD_USER_3
ACCEPTED, REJECTED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_TEMPORARILY_REJECTED
IN_PROGRESS, CANCELLED = mavlink.MAV_RESULT_IN_PROGRESS, MAV_RESULT_CANCELLED
OWN = 1, mavlink.MAV_COMP_ID_ONBOARD_COMPUTER
REAL32 = mavlink.MAV_PARAM_TYPE_REAL32


@dataclass
class Station:
    """A ground station behind the autopilot."""

    setup: Setup = field(default_factory=lambda: Setup(is_component=True))
    codec: MavlinkCodec = field(default_factory=lambda: MavlinkCodec(255, 190))

    def send(self, message: Message) -> None:
        self.setup.node.receive_mavlink(self.codec.encode(message), self.setup.t_ns)

    def command(self, command: int, param1: float = 0.0, confirmation: int = 0, target: tuple[int, int] = OWN) -> None:
        self.send(mavlink.MAVLink_command_long_message(*target, command, confirmation, param1, 0, 0, 0, 0, 0, 0))

    def heard(self, kind: str) -> list[Message]:
        return self.setup.autopilot.of_type(kind)

    def answers(self, command: int) -> list[tuple[int, int]]:
        """Result and percentage of each acknowledgement to us."""
        mine = [one for one in self.heard("COMMAND_ACK") if (one.target_system, one.target_component) == (255, 190)]
        return [(one.result, one.progress) for one in mine if one.command == command]


def _ready() -> Station:
    station = Station()
    station.setup.run(3.0, station.setup.fixes)
    assert station.setup.node.autopilot.state.places_drone
    assert station.setup.node.vehicle_heard
    return station


@pytest.mark.slow
def test_start_for_a_vehicle_that_was_never_heard_is_refused() -> None:
    station = Station()
    station.setup.run(3.0)
    station.command(START)
    station.setup.run(0.5)
    assert station.answers(START) == [(REJECTED, 255)]
    assert station.setup.node.phase is Phase.IDLE


def test_stations_abort_is_obeyed_while_an_operator_asks_for_a_start_in_every_step() -> None:
    station = _ready()
    node = station.setup.node
    replies = list[CommandReply]()

    def insist() -> None:
        station.setup.fixes()
        node.request(Command.START)
        replies.extend(node.take_replies())

    station.setup.run(0.5, insist)
    assert node.phase is Phase.TAKEOFF
    station.command(ABORT)
    station.setup.run(0.1, insist)
    assert station.answers(ABORT) == [(ACCEPTED, 255)]
    assert replies[0].accepted


@pytest.mark.slow
def test_start_is_in_progress_until_an_abort_cancels_it() -> None:
    station = _ready()
    station.command(START)
    station.setup.run(2.5)
    assert station.setup.node.phase is Phase.TAKEOFF
    assert station.answers(START) == [(IN_PROGRESS, 10)] * 3
    station.command(ABORT)
    station.setup.run(0.2)
    assert station.answers(ABORT) == [(ACCEPTED, 255)]
    assert station.answers(START)[3:] == [(CANCELLED, 255)]


def test_start_is_cancelled_by_its_own_message() -> None:
    station = _ready()
    station.command(START)
    station.setup.run(0.5)
    station.send(DRAFT_MESSAGES[80](*OWN, START))
    station.setup.run(0.2)
    assert station.answers(START)[-1] == (CANCELLED, 255)


@pytest.mark.slow
def test_command_that_is_sent_again_is_not_done_again() -> None:
    station = _ready()
    station.command(START)
    station.setup.run(0.1)
    station.command(START, confirmation=1)
    station.setup.run(0.1)
    assert {result for result, _ in station.answers(START)} == {IN_PROGRESS}
    for confirmation in (0, 1):
        station.command(HOLD, confirmation=confirmation)
        station.setup.run(0.1)
    assert station.answers(HOLD) == [(ACCEPTED, 255)] * 2


def test_refusal_comes_with_its_reason_in_words() -> None:
    station = _ready()
    station.command(HOLD)
    station.setup.run(0.1)
    assert station.answers(HOLD) == [(REJECTED, 255)]
    assert "nothing to hold" in "".join(text.text for text in station.heard("STATUSTEXT"))


def test_command_that_does_not_name_the_component_does_nothing() -> None:
    station = _ready()
    for target in ((1, 0), (0, 191), (1, 1), (2, 191)):
        station.command(START, target=target)
    station.setup.run(0.2)
    assert station.setup.node.phase is Phase.IDLE
    assert station.answers(START) == []


def test_commands_can_be_denied_by_the_configuration() -> None:
    config = CompanionConfig(ground_station=GroundStationConfig(takes_mavlink_commands=False))
    station = Station(Setup(is_component=True, config=config))
    station.setup.run(3.0)
    station.command(START)
    station.setup.run(0.2)
    assert station.answers(START) == [(mavlink.MAV_RESULT_DENIED, 255)]
    assert station.setup.node.phase is Phase.IDLE
    station.send(mavlink.MAVLink_param_set_message(*OWN, b"DL_WAIT_ALT", 7.3, REAL32))
    station.setup.run(0.2)
    assert station.setup.node.system.config == config


def test_component_tells_who_it_is_and_refuses_what_it_does_not_know() -> None:
    station = _ready()
    station.command(mavlink.MAV_CMD_REQUEST_MESSAGE, 396.0)
    station.command(mavlink.MAV_CMD_REQUEST_MESSAGE, float(mavlink.MAVLINK_MSG_ID_ATTITUDE))
    station.command(mavlink.MAV_CMD_NAV_LAND)
    station.setup.run(0.1)
    (told,) = station.heard("COMPONENT_INFORMATION_BASIC")
    assert bytes(told.vendor_name).startswith(b"Decklander")
    unsupported = (mavlink.MAV_RESULT_UNSUPPORTED, 255)
    assert station.answers(mavlink.MAV_CMD_REQUEST_MESSAGE) == [(ACCEPTED, 255), unsupported]
    assert station.answers(mavlink.MAV_CMD_NAV_LAND) == [unsupported]


def test_heartbeat_tells_the_phase() -> None:
    station = _ready()
    station.command(START)
    station.setup.run(1.5)
    states = [(beat.system_status, beat.custom_mode) for beat in station.heard("HEARTBEAT")]
    assert (mavlink.MAV_STATE_STANDBY, 0) in states
    assert states[-1] == (mavlink.MAV_STATE_ACTIVE, 1)


def test_value_that_was_set_is_flown_by_and_none_is_set_in_flight() -> None:
    station = _ready()
    station.send(mavlink.MAVLink_param_set_message(*OWN, b"DL_WAIT_ALT", 7.3, REAL32))
    station.setup.run(0.1)
    assert station.setup.node.system.config.takeoff.waiting_height_m == 7.3
    station.command(START)
    station.setup.run(0.2)
    station.send(mavlink.MAVLink_param_set_message(*OWN, b"DL_WAIT_ALT", 9.0, REAL32))
    station.setup.run(0.1)
    assert station.heard("PARAM_VALUE")[-1].param_value == pytest.approx(7.3)


@pytest.mark.slow
@pytest.mark.parametrize(("on_map", "kinds"), [(PadOnMap.NONE, 0), (PadOnMap.FOLLOW_TARGET, 1), (PadOnMap.ADSB, 2)])
def test_pad_is_told_where_it_is(on_map: PadOnMap, kinds: int) -> None:
    setup = Setup(is_component=True, config=CompanionConfig(ground_station=GroundStationConfig(pad_on_map=on_map)))
    setup.node.receive_pad(PadGeometry(size_m=(1.5, 1.5), height_m=1.5, antenna_to_pad_m=(0.0, 0.0, 0.0)))
    setup.run(6.0, lambda: setup.fixes((-30.0, 40.0, 1.5)))
    told = [setup.autopilot.of_type(kind) for kind in ("FOLLOW_TARGET", "ADSB_VEHICLE")]
    assert [bool(messages) for messages in told] == [kinds > 0, kinds > 1]
    frame = setup.node.autopilot.state.view.frame or FRAME
    for message in [messages[-1] for messages in told if messages]:
        assert _metres_from(frame.origin, message) == pytest.approx((-30.0, 40.0), abs=0.3)


def _metres_from(origin: Datum, message: Message) -> tuple[float, float]:
    """East and north, on a sphere, which is right to 0.2 m over 50 m."""
    north = (math.radians(message.lat * 1e-7) - origin.latitude_rad) * 6371000.0
    east = (math.radians(message.lon * 1e-7) - origin.longitude_rad) * 6371000.0 * math.cos(origin.latitude_rad)
    return east, north
