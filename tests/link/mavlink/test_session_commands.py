import math

import pytest

from link.mavlink.dialect import mavlink
from link.mavlink.events import CommandAcknowledged, CommandTimedOut
from link.mavlink.requests import Retries
from link.mavlink.session import MavlinkSession
from link.memory_link import MemoryLink
from tests.link.mavlink.fake_autopilot import START_NS, FakeAutopilot, Pair, S, of_kind

ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
SET_MODE = mavlink.MAV_CMD_DO_SET_MODE
POSITION_ID = mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED
ATTITUDE_ID = mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION
ACCEPTED, REJECTED, IN_PROGRESS = (
    mavlink.MAV_RESULT_ACCEPTED,
    mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
    mavlink.MAV_RESULT_IN_PROGRESS,
)


def found(**answers: tuple[int, ...]) -> Pair:
    run = Pair(session=MavlinkSession(1), autopilot=FakeAutopilot())
    run.autopilot.results.update({{"arm": ARM, "set_mode": SET_MODE}[name]: value for name, value in answers.items()})
    run.run(1.5)
    return run


def test_a_command_reaches_the_autopilot_once_and_is_acknowledged() -> None:
    run = found()
    ticket = run.session.command(ARM, (1.0,), run.t_ns)
    (ack,) = of_kind(run.run(3.0), CommandAcknowledged)
    assert (ack.command, ack.result, ack.ticket, ack.is_repeat) == (ARM, ACCEPTED, ticket, False)
    (sent,) = run.autopilot.of_type("COMMAND_LONG")
    assert (sent.target_system, sent.target_component, sent.param1, sent.param7) == (1, 1, 1.0, 0.0)


def test_an_unanswered_command_is_repeated_with_a_rising_count_and_then_given_up() -> None:
    run = found(arm=())
    ticket = run.session.command(ARM, (1.0,), run.t_ns)
    (timed_out,) = of_kind(run.run(5.0), CommandTimedOut)
    assert (timed_out.ticket, timed_out.attempts) == (ticket, 5)
    assert [one.confirmation for one in run.autopilot.of_type("COMMAND_LONG")] == [0, 1, 2, 3, 4]


def test_a_command_is_repeated_as_often_and_as_soon_as_its_owner_says() -> None:
    run = found(arm=())
    ticket = run.session.command(ARM, (0.0,), run.t_ns, Retries(attempts=2, patience_ns=S // 5))
    assert of_kind(run.run(0.3), CommandTimedOut) == []
    (timed_out,) = of_kind(run.run(0.15), CommandTimedOut)
    assert (timed_out.ticket, timed_out.attempts) == (ticket, 2)


def test_both_acks_of_a_mode_change_are_told() -> None:
    run = found(set_mode=(ACCEPTED, REJECTED))
    ticket = run.session.command(SET_MODE, (1.0, 6.0), run.t_ns)
    acks = of_kind(run.run(1.0), CommandAcknowledged)
    assert [(one.result, one.ticket, one.is_repeat) for one in acks] == [
        (ACCEPTED, ticket, False),
        (REJECTED, ticket, True),
    ]


def test_progress_stops_the_repeating_and_waits_for_the_end() -> None:
    run = found(arm=(IN_PROGRESS,))
    ticket = run.session.command(ARM, (1.0,), run.t_ns)
    run.run(6.0)
    run.autopilot.acknowledge(ARM, ACCEPTED)
    (ack,) = of_kind(run.run(1.0), CommandAcknowledged)
    assert (ack.result, ack.ticket, ack.is_repeat) == (ACCEPTED, ticket, False)
    assert len(run.autopilot.of_type("COMMAND_LONG")) == 1


def test_progress_without_an_end_times_out() -> None:
    run = found(arm=(IN_PROGRESS,))
    ticket = run.session.command(ARM, (1.0,), run.t_ns)
    assert [one.ticket for one in of_kind(run.run(12.0), CommandTimedOut)] == [ticket]


def test_an_ack_that_nobody_asked_for_has_no_ticket() -> None:
    run = found()
    run.autopilot.acknowledge(ARM, ACCEPTED)
    (ack,) = of_kind(run.run(0.1), CommandAcknowledged)
    assert (ack.ticket, ack.is_repeat) == (None, True)


def test_two_commands_of_a_kind_are_answered_one_by_one() -> None:
    run = found()
    tickets = [run.session.request_message(message_id, run.t_ns) for message_id in (49, 242)]
    acks = of_kind(run.run(1.0), CommandAcknowledged)
    assert [one.ticket for one in acks] == tickets
    assert [one.param1 for one in run.autopilot.of_type("COMMAND_LONG")] == [49.0, 242.0]


def test_a_command_with_nobody_to_send_it_to_times_out() -> None:
    session = MavlinkSession(1)
    ticket = session.command(ARM, (1.0,), START_NS)
    events = [event for k in range(100) for event in session.poll(START_NS + k * S // 10)]
    assert [one.ticket for one in of_kind(events, CommandTimedOut)] == [ticket]


@pytest.mark.parametrize("params", [(1.0,) * 8, (math.inf,)])
def test_parameters_that_cannot_be_are_an_error_of_the_caller(params: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="up to 7 parameters"):
        MavlinkSession(1).command(ARM, params, START_NS)


def test_streams_are_asked_for_by_interval_even_before_the_autopilot_is_there() -> None:
    run = Pair(session=MavlinkSession(1), autopilot=FakeAutopilot(mute=True))
    run.session.request_interval(POSITION_ID, 50.0, run.t_ns)
    run.session.request_interval(ATTITUDE_ID, 100.0, run.t_ns)
    run.run(8.0)
    run.autopilot.mute = False
    assert of_kind(run.run(4.0), CommandTimedOut) == []
    assert run.autopilot.intervals_ns == {POSITION_ID: 20_000_000, ATTITUDE_ID: 10_000_000}


def test_a_stream_that_was_granted_and_stays_away_is_asked_for_again() -> None:
    run = found()
    run.session.request_interval(POSITION_ID, 50.0, run.t_ns)
    run.run(2.0)
    run.autopilot.intervals_ns.clear()
    run.run(7.0)
    assert POSITION_ID in run.autopilot.intervals_ns


def test_a_stream_that_flows_is_asked_for_once() -> None:
    run = found()
    run.session.request_interval(POSITION_ID, 50.0, run.t_ns)
    run.run(20.0)
    assert len(run.autopilot.of_type("COMMAND_LONG")) == 1


@pytest.mark.parametrize(("result", "asked_again"), [(mavlink.MAV_RESULT_DENIED, False), (REJECTED, True)])
def test_a_refused_stream_is_asked_for_again_only_if_refused_for_now(result: int, asked_again: bool) -> None:
    run = found()
    run.autopilot.results[mavlink.MAV_CMD_SET_MESSAGE_INTERVAL] = (result,)
    run.session.request_interval(POSITION_ID, 50.0, run.t_ns)
    run.run(8.0)
    assert (len(run.autopilot.of_type("COMMAND_LONG")) > 1) is asked_again


def test_a_rate_of_zero_stops_a_stream() -> None:
    run = found()
    run.session.request_interval(POSITION_ID, 0.0, run.t_ns)
    run.run(20.0)
    assert [one.param2 for one in run.autopilot.of_type("COMMAND_LONG")] == [-1.0]


@pytest.mark.parametrize("rate_hz", [-1.0, math.nan, math.inf])
def test_a_rate_that_cannot_be_is_an_error_of_the_caller(rate_hz: float) -> None:
    with pytest.raises(ValueError, match="rate must be finite"):
        MavlinkSession(1).request_interval(POSITION_ID, rate_hz, START_NS)


def lossy(seed: int) -> Pair:
    def link(number: int) -> MemoryLink:
        return MemoryLink(
            seed=2 * seed + number, delay_s=0.1, jitter_s=0.05, loss=0.2, duplication=0.1, corruption=0.05
        )

    return Pair(session=MavlinkSession(1), autopilot=FakeAutopilot(drift=0.01), up=link(0), down=link(1))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_a_lossy_link_gets_everything_done_in_the_end(seed: int) -> None:
    run = lossy(seed)
    run.autopilot.parameters = {"MPC_XY_VEL_MAX": (12.0, mavlink.MAV_PARAM_TYPE_REAL32)}
    for message_id in (POSITION_ID, ATTITUDE_ID):
        run.session.request_interval(message_id, 50.0, run.t_ns)
    run.run(2.0)
    ticket = run.session.command(ARM, (1.0,), run.t_ns, Retries(attempts=10))
    run.session.read_parameter("MPC_XY_VEL_MAX", run.t_ns)
    events = run.run(18.0)
    names = {type(one).__name__ for one in events}
    assert ticket in {one.ticket for one in of_kind(events, CommandAcknowledged)}
    assert {"ParameterRead"} <= names
    assert names.isdisjoint({"LinkLost", "AutopilotRestarted", "CommandTimedOut", "ParameterMissing"})
    assert set(run.autopilot.intervals_ns) == {POSITION_ID, ATTITUDE_ID}
    error_ns = abs((run.session.clock.local_to_boot_ns(run.t_ns) or 0) - run.autopilot.boot_ns(run.t_ns))
    assert error_ns < 40_000_000  # 100 +- 50 ms each way bound it by 50 ms
    assert 0.1 < run.session.statistics.codec.lost_messages / run.session.statistics.codec.messages_received < 0.5


def test_the_same_seed_gives_the_same_events() -> None:
    def told() -> list[str]:
        run = lossy(3)
        run.session.request_interval(POSITION_ID, 50.0, run.t_ns)
        return [f"{type(one).__name__} {one.t_ns}" for one in run.run(5.0)]

    assert told() == told()
