"""Which setpoints an autopilot has heard, by what it says that it flies to."""

import pytest

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.driver import Driver
from companion.autopilots.px4 import Px4Driver
from companion.autopilots.sent_setpoints import SentSetpoints
from companion.core.data import Setpoint
from link.mavlink.answers import ANSWER_GAP_S
from link.mavlink.dialect import Message, mavlink
from link.mavlink.session import MavlinkSession
from tests.link.mavlink.fake_autopilot import MS, START_NS

DRIVERS: list[Driver] = [Px4Driver(), ArduPilotDriver()]
NO_PLACE = 0b0000_0000_0000_0111
COUNT = 10


def setpoint(number: int) -> Setpoint:
    """One of a descent that turns into a press, 20 ms after the one before."""
    return Setpoint(
        t_ns=0,
        position_enu_m=(0.1 * number, 3.7, 2.0 - 0.009 * number),
        velocity_enu_m_s=(5.0, 0.3, -0.45 - 0.01 * number),
        acceleration_enu_m_s2=(0.2, -0.1, -0.5 - 0.02 * number),
        yaw_rad=0.4,
    )


def told(driver: Driver, number: int, later_s: float) -> Message:
    """What is told of a setpoint so long after it came: PX4 holds its place, ArduCopter carries it on."""
    sent = driver.setpoint_message(setpoint(number), 0, 1)
    place, speeds, pushes = (tuple(getattr(sent, f"{kind}{axis}") for axis in "xyz") for kind in ("", "v", "af"))
    if driver.name == "px4":
        speeds, pushes = tuple(0.9 * one for one in speeds), (0.3, 0.1, -0.4)
    else:
        speeds = tuple(one + later_s * push for one, push in zip(speeds, pushes, strict=True))
        place = tuple(one + later_s * along for one, along in zip(place, speeds, strict=True))
    return mavlink.MAVLink_position_target_local_ned_message(0, 1, 0, *place, *speeds, *pushes, 0.0, 0.0)


def sent_setpoints(driver: Driver) -> SentSetpoints:
    setpoints = SentSetpoints(MavlinkSession(1, target_system_id=1))
    for number in range(COUNT):
        setpoints.send(setpoint(number), driver, sent_ns(number))
    return setpoints


def sent_ns(number: int) -> int:
    return START_NS + 20 * number * MS


@pytest.mark.parametrize("driver", DRIVERS, ids=lambda one: one.name)
def test_setpoint_that_is_flown_to_was_heard_and_an_older_one_told_later_changes_nothing(driver: Driver) -> None:
    setpoints = sent_setpoints(driver)
    for number in (7, 4):
        setpoints.hear(told(driver, number, 0.037), driver, sent_ns(COUNT))
    assert setpoints.answers.sent_ns == sent_ns(7)
    assert setpoints.answers.since_ns == sent_ns(COUNT)


@pytest.mark.parametrize("driver", DRIVERS, ids=lambda one: one.name)
def test_setpoint_that_was_never_sent_tells_nothing(driver: Driver) -> None:
    setpoints = sent_setpoints(driver)
    setpoints.hear(told(driver, COUNT + 3, 0.0), driver, sent_ns(COUNT))
    assert setpoints.answers.sent_ns is None


def test_arducopter_that_has_stopped_flies_to_no_setpoint() -> None:
    driver = ArduPilotDriver()
    setpoints = SentSetpoints(MavlinkSession(1, target_system_id=1))
    steady = Setpoint(
        t_ns=0,
        position_enu_m=(1.0, 2.0, 3.0),
        velocity_enu_m_s=(0.0, 0.0, -0.45),
        acceleration_enu_m_s2=(0.0, 0.0, 0.0),
        yaw_rad=0.0,
    )
    setpoints.send(steady, driver, START_NS)
    still = mavlink.MAVLink_position_target_local_ned_message(0, 1, 0, 2.0, 1.0, -3.0, *(0.0,) * 8)
    setpoints.hear(still, driver, START_NS + 5 * MS)
    assert setpoints.answers.sent_ns is None


def test_arducopter_does_not_carry_a_setpoint_on_for_longer_than_a_gap() -> None:
    driver, setpoints = ArduPilotDriver(), sent_setpoints(ArduPilotDriver())
    setpoints.hear(told(driver, COUNT - 1, 1.1 * ANSWER_GAP_S), driver, sent_ns(COUNT))
    assert setpoints.answers.sent_ns is None


def test_px4_that_has_felt_the_ground_presses_down_by_itself() -> None:
    driver, setpoints = Px4Driver(), sent_setpoints(Px4Driver())
    pressed = mavlink.MAVLink_position_target_local_ned_message(0, 1, NO_PLACE, *(0.0,) * 8, 100.0, 0.0, 0.0)
    setpoints.hear(pressed, driver, sent_ns(COUNT))
    assert setpoints.answers.sent_ns == sent_ns(COUNT - 1)


def test_restart_forgets_what_was_sent_and_what_was_heard() -> None:
    driver, setpoints = Px4Driver(), sent_setpoints(Px4Driver())
    setpoints.hear(told(driver, 7, 0.0), driver, sent_ns(COUNT))
    setpoints.start_over()
    setpoints.hear(told(driver, 7, 0.0), driver, sent_ns(COUNT))
    assert setpoints.answers.sent_ns is None
