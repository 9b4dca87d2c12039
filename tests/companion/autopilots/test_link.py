"""The conversation with the autopilot: no command is ever late, and a restart begins anew."""

import math

import pytest

from companion.autopilots.driver import AutopilotCommand
from companion.autopilots.link import AutopilotLink
from companion.autopilots.messages import arm
from companion.config.companion import CompanionConfig
from companion.core.data import Setpoint
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.session import MavlinkSession
from link.records import replace
from tests.companion.peer import FakePx4
from tests.link.mavlink.fake_autopilot import MS, START_NS

ASK = mavlink.MAV_CMD_REQUEST_MESSAGE
DISARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
PLAIN = AutopilotCommand(command=DISARM, parameters=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
FORCED = AutopilotCommand(command=DISARM, parameters=(0.0, 21196.0, 0.0, 0.0, 0.0, 0.0, 0.0))
RETRY_S = 0.5


class Talk:
    """A link and a PX4 that exchange bytes every 5 ms."""

    def __init__(self, autopilot: FakePx4) -> None:
        self.link, self.autopilot, self.t_ns = AutopilotLink(MavlinkSession(1)), autopilot, START_NS
        self.run(1.5)

    def run(self, duration_s: float) -> None:
        for _ in range(round(duration_s * 200)):
            self.t_ns += 5 * MS
            self.autopilot.tick(self.t_ns)
            for data in self.autopilot.take_output():
                self.link.receive(data, self.t_ns)
            self.link.poll(self.t_ns)
            for frame in self.link.session.take_output():
                self.autopilot.receive(frame, self.t_ns)

    def utc_ahead_ns(self) -> int:
        return self.link.session.clock.local_to_utc_ns(self.t_ns) - self.t_ns

    def is_armed(self) -> bool:
        return self.link.state.view.armed

    def is_up(self) -> bool:
        return self.link.state.view.link_up

    def disarms(self) -> list[float]:
        return [message.param2 for message in self.autopilot.commands(DISARM)]


def test_unanswered_disarm_leaves_no_others_behind_it_for_a_later_situation() -> None:
    talk = Talk(FakePx4(results={DISARM: ()}))
    talk.link.send_commands((PLAIN,), talk.t_ns)
    for _ in range(4):
        talk.run(0.1)
        talk.link.send_commands((FORCED,), talk.t_ns)
    talk.run(5.0 * RETRY_S)
    assert talk.disarms() == [0.0]


@pytest.mark.parametrize(("command", "patience_s"), [(PLAIN, RETRY_S), (arm(armed=False), 0.2)])
def test_next_disarm_goes_out_once_the_first_has_run_out_of_time(command: AutopilotCommand, patience_s: float) -> None:
    talk = Talk(FakePx4(results={DISARM: ()}))
    talk.link.send_commands((command,), talk.t_ns)
    talk.run(patience_s - 0.05)
    talk.link.send_commands((command,), talk.t_ns)
    talk.run(0.1)
    assert talk.disarms() == [0.0]
    talk.link.send_commands((command,), talk.t_ns)
    talk.run(0.1)
    assert talk.disarms() == [0.0, 0.0]


def test_answer_frees_the_way_and_is_told_once() -> None:
    talk = Talk(FakePx4(results={DISARM: (mavlink.MAV_RESULT_TEMPORARILY_REJECTED,)}))
    talk.link.send_commands((PLAIN,), talk.t_ns)
    talk.run(0.1)
    answers = [answer for answer in talk.link.take_acknowledgements() if answer[0] == DISARM]
    assert answers == [(DISARM, mavlink.MAV_RESULT_TEMPORARILY_REJECTED)]
    assert talk.link.take_acknowledgements() == ()
    talk.link.send_commands((FORCED,), talk.t_ns)
    talk.run(0.1)
    assert talk.disarms() == [0.0, 21196.0]


def test_setpoint_that_is_not_finite_is_counted_and_not_sent() -> None:
    talk = Talk(FakePx4())
    for bad in (math.nan, math.inf, 1e39):
        setpoint = Setpoint(
            t_ns=talk.t_ns,
            position_enu_m=(0.0, bad, 1.0),
            velocity_enu_m_s=None,
            acceleration_enu_m_s2=None,
            yaw_rad=0.0,
        )
        talk.link.send_setpoint(setpoint, talk.t_ns)
    talk.run(0.1)
    assert talk.link.setpoints.bad == 3
    assert not talk.autopilot.setpoints()


def test_restarted_autopilot_is_taken_for_disarmed_and_its_old_places_are_forgotten() -> None:
    talk = Talk(FakePx4(armed=True))
    talk.run(1.0)
    count = talk.link.state.view.frame_moves.origin_count
    assert talk.is_armed()
    talk.autopilot.armed = False
    talk.autopilot.restart(talk.t_ns)
    talk.run(4.0)
    assert not talk.is_armed()
    assert talk.link.state.view.restarted
    assert talk.link.state.view.frame_moves.origin_count > count
    assert talk.link.state.own is not None


SPEED_MAX = "MPC_XY_VEL_MAX"


@pytest.mark.parametrize("restarts", [False, True], ids=["silence", "restart"])
def test_parameter_that_was_changed_while_nobody_was_heard_is_read_again(restarts: bool) -> None:
    talk = Talk(FakePx4(parameters={SPEED_MAX: (12.0, mavlink.MAV_PARAM_TYPE_REAL32)}))
    assert talk.link.state.parameters[SPEED_MAX] == 12.0
    talk.autopilot.mute = True
    talk.run(3.5)
    if restarts:
        talk.autopilot.restart(talk.t_ns)
    talk.autopilot.parameters[SPEED_MAX] = (4.0, mavlink.MAV_PARAM_TYPE_REAL32)
    talk.autopilot.mute = False
    talk.run(1.5)
    assert talk.link.state.parameters[SPEED_MAX] == 4.0


@pytest.mark.parametrize("was_armed", [False, True])
def test_autopilot_of_another_kind_is_driven_as_such_once_it_has_told_so_twice_with_its_motors_off(
    *, was_armed: bool
) -> None:
    talk = Talk(FakePx4(armed=was_armed))
    talk.run(2.0)
    assert talk.link.driver is not None
    assert talk.link.driver.name == "px4"
    talk.autopilot.firmware, talk.autopilot.armed = mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, False
    talk.run(0.9)
    assert talk.link.driver.name == "px4"
    talk.run(2.2)
    assert talk.link.driver.name == "ardupilot"
    assert not talk.link.state.parameters
    talk.autopilot.firmware = mavlink.MAV_AUTOPILOT_PX4
    talk.autopilot.armed = True
    talk.run(5.0)
    assert talk.link.driver.name == "ardupilot"


def test_parameter_that_a_quick_restart_has_changed_is_read_again() -> None:
    talk = Talk(FakePx4(parameters={SPEED_MAX: (12.0, mavlink.MAV_PARAM_TYPE_REAL32)}))
    talk.autopilot.restart(talk.t_ns)
    talk.autopilot.parameters[SPEED_MAX] = (4.0, mavlink.MAV_PARAM_TYPE_REAL32)
    talk.run(4.0)
    assert talk.link.state.view.restarted
    assert talk.link.state.parameters[SPEED_MAX] == 4.0


def test_origin_that_somebody_tells_once_is_asked_for_and_not_believed() -> None:
    talk = Talk(FakePx4())
    talk.run(1.0)
    frame, asked = talk.link.state.view.frame, len(talk.autopilot.commands(ASK))
    forged = MavlinkCodec(1, 1).encode(mavlink.MAVLink_gps_global_origin_message(524_000_000, 134_000_000, 100_000))
    talk.link.receive(forged, talk.t_ns, is_datagram=True)
    talk.run(0.5)
    assert len(talk.autopilot.commands(ASK)) > asked
    assert talk.link.state.view.frame == frame


def test_silent_autopilot_is_said_to_be_lost_and_found_again() -> None:
    talk = Talk(FakePx4())
    assert talk.is_up()
    talk.autopilot.mute = True
    talk.run(4.0)
    assert not talk.is_up()
    talk.autopilot.mute = False
    talk.run(1.5)
    assert talk.is_up()


def test_limits_follow_each_change_of_the_autopilots_parameters_and_of_what_is_wanted() -> None:
    talk, wanted = Talk(FakePx4()), CompanionConfig().limits.flight_limits()
    for speed_m_s in (7.0, 3.0):
        known = {**talk.link.state.parameters, "MPC_XY_VEL_MAX": speed_m_s}
        talk.link.state = replace(talk.link.state, parameters=known)
        assert talk.link.limits(wanted).speed_max_m_s == speed_m_s
        assert talk.link.limits(replace(wanted, speed_max_m_s=1.5)).speed_max_m_s == 1.5


@pytest.mark.slow
@pytest.mark.parametrize("set_by_s", [-30.0, -0.9, -0.7, 0.7, 30.0])
def test_drone_is_never_taken_for_silent_when_utc_is_set(set_by_s: float) -> None:
    talk = Talk(FakePx4())
    talk.run(4.0)  # by then the clocks' drift is known
    before_ns = talk.utc_ahead_ns()
    talk.autopilot.utc_set_by_ns = round(set_by_s * 1e9)
    for _ in range(600):
        talk.run(0.005)
        own = talk.link.state.own
        assert own is not None
        assert abs(talk.utc_ahead_ns() + talk.t_ns - own.t_ns) < 50 * MS
    assert talk.utc_ahead_ns() - before_ns == pytest.approx(set_by_s * 1e9, abs=10 * MS)


@pytest.mark.slow
def test_limit_that_was_not_told_is_asked_for_until_it_is() -> None:
    talk = Talk(FakePx4(parameters={"MPC_Z_VEL_MAX_UP": (2.0, mavlink.MAV_PARAM_TYPE_REAL32)}))
    talk.run(10.0)
    wanted = CompanionConfig().limits.flight_limits()
    assert talk.link.limits(wanted).speed_max_m_s == 12.0  # the firmware's default meanwhile
    talk.autopilot.parameters["MPC_XY_VEL_MAX"] = (7.0, mavlink.MAV_PARAM_TYPE_REAL32)
    talk.run(8.0)
    assert talk.link.limits(wanted).speed_max_m_s == 7.0


@pytest.mark.slow
def test_origin_is_asked_for_one_question_at_a_time_while_none_is_answered() -> None:
    talk = Talk(FakePx4(results={ASK: ()}))
    talk.run(20.0)
    unanswered = len(talk.autopilot.commands(ASK))
    assert unanswered > 20  # it goes on asking
    talk.autopilot.results = {}
    talk.run(0.9)
    assert talk.link.state.view.frame is not None
    assert len(talk.autopilot.commands(ASK)) - unanswered <= 2


def test_origin_that_is_refused_is_asked_for_again_each_second() -> None:
    talk = Talk(FakePx4(results={ASK: (mavlink.MAV_RESULT_TEMPORARILY_REJECTED,)}))
    talk.run(8.5)
    assert len(talk.autopilot.commands(ASK)) == 10
    talk.autopilot.results = {}
    talk.run(1.1)
    assert talk.link.state.view.frame is not None
