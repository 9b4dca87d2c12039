"""Several MAVLink links at once: streams, answers, and what is passed on from one to another."""

import itertools

import pytest

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.runtime.build import autopilot_config, with_default_links
from sim_autopilot.runtime.config import SimAutopilotConfig
from tests.sim_autopilot.clients import Clients, beat
from tests.sim_autopilot.copter import ardupilot
from tests.sim_autopilot.pilot import arm, command, px4

ATTITUDE = mavlink.MAVLINK_MSG_ID_ATTITUDE


def every(message_id: int, hz: float) -> Message:
    return command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, float(message_id), 1e6 / hz)


def test_each_link_has_streams_of_its_own() -> None:
    clients = Clients(px4())
    clients.send(1, every(ATTITUDE, 20.0))
    clients.run(0.02)
    clients.forget()
    clients.run(2.0)
    assert [clients.counts(link)["ATTITUDE"] for link in (0, 1)] == [200, 40]
    assert clients.counts(0)["ODOMETRY"] == clients.counts(1)["ODOMETRY"] == 60


def test_a_ground_link_of_px4_streams_what_a_ground_station_needs() -> None:
    config = autopilot_config(with_default_links(SimAutopilotConfig(instant=True)))
    clients = Clients(px4())
    clients.node = type(clients.node)(config, 1_795_000_000_000_000_000)
    clients.run(2.0)
    assert clients.counts(0)["ATTITUDE"] == pytest.approx(200, abs=1)
    assert clients.counts(1)["ATTITUDE"] == pytest.approx(100, abs=1)
    assert (clients.counts(0)["ODOMETRY"] > 0, clients.counts(1)["ODOMETRY"]) == (True, 0)


def test_a_command_is_answered_on_its_own_link_only() -> None:
    clients = Clients(px4())
    clients.send(1, arm(armed=False))
    clients.run(0.05)
    assert [clients.counts(link)["COMMAND_ACK"] for link in (0, 1)] == [0, 1]


def test_px4_sends_texts_only_where_a_ground_station_is() -> None:
    clients = Clients(px4(instant=False))
    clients.send(0, beat())
    clients.send(1, beat(mavlink.MAV_TYPE_ONBOARD_CONTROLLER))
    for link in (0, 1):
        clients.send(link, arm())
    clients.run(0.1)
    assert [clients.counts(link)["STATUSTEXT"] > 0 for link in (0, 1)] == [True, False]


def test_sequence_numbers_have_no_gaps_on_any_link() -> None:
    clients = Clients(px4(), links=3)
    clients.send(2, every(ATTITUDE, 125.0), beat())
    clients.send(0, every(ATTITUDE, 7.0))
    clients.run(3.0)
    assert [codec.statistics.lost_messages for codec in clients.codecs] == [0, 0, 0]
    assert all(codec.statistics.messages_received > 300 for codec in clients.codecs)


@pytest.mark.slow
@pytest.mark.parametrize("rate_hz", [1.0, 30.0, 125.0])
def test_a_stream_is_as_fast_as_asked_and_evenly_spaced(rate_hz: float) -> None:
    clients = Clients(px4())
    clients.send(0, every(mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, rate_hz))
    clients.run(0.02)
    clients.forget()
    clients.run(4.0)
    times_ms = [message.time_boot_ms for message in clients.of(0, "ATTITUDE_QUATERNION")]
    assert len(times_ms) == pytest.approx(4.0 * rate_hz, abs=1.0)
    gaps_ms = [later - earlier for earlier, later in itertools.pairwise(times_ms)]
    assert all(abs(gap - 1000.0 / rate_hz) < 10.0 for gap in gaps_ms)
    assert min(gaps_ms, default=1) > 0


def test_statistics_are_kept_for_each_link() -> None:
    clients = Clients(px4())
    clients.send(1, beat(), beat())
    clients.send_bytes(0, b"noise")
    first, second = clients.node.statistics
    assert (first.messages_received, first.bad_bytes) == (0, 5)
    assert (second.messages_received, second.bad_bytes) == (2, 0)


def test_peers_of_one_link_do_not_mix_their_bytes() -> None:
    clients = Clients(px4())
    frame = MavlinkCodec(255, 190).encode(beat())
    for part in (frame[:7], frame[7:]):
        for peer in (0, 1):
            clients.node.receive(part, clients.node.state.t_ns, 0, peer)
    statistics = clients.node.statistics[0]
    assert (statistics.messages_received, statistics.bad_bytes) == (2, 0)


def test_broadcasts_are_passed_on_to_the_other_links_and_never_back() -> None:
    clients = Clients(px4(), links=3)
    clients.send(0, beat())
    assert [clients.counts(link)["HEARTBEAT"] for link in range(3)] == [0, 1, 1]
    assert clients.of(2, "HEARTBEAT")[0].get_srcSystem() == 255


def test_what_is_addressed_goes_only_where_the_addressee_was_heard() -> None:
    clients = Clients(px4(), links=3)
    question = mavlink.MAVLink_param_request_list_message(1, 192)
    clients.send(0, question)
    assert sum(clients.counts(link)["PARAM_REQUEST_LIST"] for link in range(3)) == 0
    clients.send(2, beat(mavlink.MAV_TYPE_ONBOARD_CONTROLLER))
    clients.send(0, question)
    assert [clients.counts(link)["PARAM_REQUEST_LIST"] for link in range(3)] == [0, 0, 1]


def test_what_is_for_the_autopilot_alone_is_not_passed_on() -> None:
    clients = Clients(px4(), links=3)
    for link in range(3):
        clients.send(link, beat())
    clients.send(0, arm(armed=False))
    assert sum(clients.counts(link)["COMMAND_LONG"] for link in range(3)) == 0


@pytest.mark.parametrize(
    "message",
    [
        mavlink.MAVLink_radio_status_message(1, 2, 3, 4, 5, 6, 7),
        mavlink.MAVLink_setup_signing_message(0, 0, bytes(32), 0),
    ],
)
def test_what_concerns_one_link_or_is_secret_is_not_passed_on(message: Message) -> None:
    clients = Clients(px4())
    clients.send(0, message)
    assert clients.sent[1] == 0


def test_an_echo_of_our_own_messages_is_not_passed_on() -> None:
    clients = Clients(px4())
    clients.send_bytes(0, MavlinkCodec(1, 1).encode(beat()))
    assert clients.sent == [0, 0]


def test_a_flood_of_made_up_systems_does_not_push_out_who_still_speaks() -> None:
    clients = Clients(px4())
    for system in range(2, 250):
        clients.send_bytes(0, MavlinkCodec(system, 1).encode(beat()))
        clients.send(1, beat(mavlink.MAV_TYPE_ONBOARD_CONTROLLER))
    clients.forget()
    clients.send(0, mavlink.MAVLink_param_request_list_message(1, 191))
    assert clients.counts(1)["PARAM_REQUEST_LIST"] == 1


@pytest.mark.parametrize(("config", "answers"), [(px4(), 1), (ardupilot(), 0)])
def test_px4_answers_a_ping_to_everybody_and_ardupilot_does_not(config: object, answers: int) -> None:
    clients = Clients(config)  # type: ignore[arg-type]  # of either kind
    clients.send(0, mavlink.MAVLink_ping_message(123, 7, 0, 0), mavlink.MAVLink_ping_message(123, 8, 1, 1))
    pings = clients.of(0, "PING")
    assert len(pings) == answers
    assert all((ping.time_usec, ping.seq, ping.target_system) == (123, 7, 255) for ping in pings)


def test_timesync_is_answered_at_once_by_the_boot_clock_and_no_answer_is_answered() -> None:
    clients = Clients(px4())
    clients.run(1.0)
    clients.forget()
    clients.send(0, mavlink.MAVLink_timesync_message(0, 42), mavlink.MAVLink_timesync_message(5, 43))
    (answer,) = clients.of(0, "TIMESYNC")
    assert (answer.tc1, answer.ts1) == (1_000_000_000, 42)


def test_a_version_1_client_is_answered_in_version_1_on_its_link_only() -> None:
    clients = Clients(px4())
    clients.send_bytes(0, beat().pack(mavlink.MAVLink(None, 255, 190), force_mavlink1=True))
    clients.forget()
    clients.run(1.0)
    assert {message.get_msgbuf()[0] for message in clients.heard[0]} == {0xFE}
    assert {message.get_msgbuf()[0] for message in clients.heard[1]} == {0xFD}
