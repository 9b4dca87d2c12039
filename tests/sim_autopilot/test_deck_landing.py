import numpy as np
import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.data import Deck, Surface
from tests.sim_autopilot.pilot import POSITION_VELOCITY, START_NS, Pilot, arm, px4, set_mode, setpoint

SPEED_M_S = 5.0
ROOF_M = 1.5
BEGINS_S = 8.0
ACCEPTED, REJECTED = 0, 1


def vehicle_y_m(t_s: float) -> float:
    """A vehicle on the way north that passes the origin."""
    return SPEED_M_S * (t_s - BEGINS_S)


def deck(t_ns: int) -> Deck:
    return Deck(
        t_ns=t_ns,
        position_enu_m=np.array((0.0, vehicle_y_m((t_ns - START_NS) * 1e-9), 0.0)),
        orientation_wxyz=np.array((np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))),
        velocity_enu_m_s=np.array((0.0, SPEED_M_S, 0.0)),
        angular_velocity_enu_rad_s=np.zeros(3),
        roof_size_m=(4.2, 1.8),
        roof_height_m=ROOF_M,
    )


def landed_on_the_roof(pilot: Pilot) -> None:
    """Take off, follow the vehicle and go down on it at 0.5 m/s, until a second after contact."""

    def hover(_t_s: float) -> Message:
        return setpoint((0.0, 0.0, -5.0))

    def follow(height_m: float, sink_m_s: float) -> Message:
        position = (vehicle_y_m(pilot.t_s + 0.01), 0.0, -height_m)
        return setpoint(position, (SPEED_M_S, 0.0, sink_m_s), mask=POSITION_VELOCITY)

    pilot.run(0.5, hover)
    pilot.step(set_mode(6), arm())
    pilot.run_until(lambda: pilot.t_s > BEGINS_S, 10.0, hover)
    pilot.run(6.0, lambda _t: follow(3.5, 0.0))
    began_s = pilot.t_s
    pilot.run_until(
        lambda: pilot.node.state.surface is Surface.DECK,
        8.0,
        lambda t: follow(3.5 - 0.5 * (t - began_s), 0.5),
    )
    pilot.run(1.0, lambda _t: follow(ROOF_M - 0.5, 0.5))


def on_deck_m(pilot: Pilot) -> tuple[float, float]:
    """Where the drone is on the roof: ahead of its middle, and above it."""
    return float(pilot.position[1]) - vehicle_y_m(pilot.t_s), float(pilot.position[2]) - ROOF_M


@pytest.mark.slow
def test_on_a_deck_at_five_metres_a_second_a_plain_disarm_is_refused_and_a_forced_one_works() -> None:
    pilot = Pilot(deck=deck)
    landed_on_the_roof(pilot)
    ahead_m, above_m = on_deck_m(pilot)
    assert abs(ahead_m) < 0.3
    assert above_m == pytest.approx(0.12, abs=0.03)
    assert pilot.last("EXTENDED_SYS_STATE").landed_state == mavlink.MAV_LANDED_STATE_IN_AIR
    assert pilot.acknowledged(arm(armed=False)) == [REJECTED]
    assert pilot.acknowledged(arm(armed=False, force=True)) == [ACCEPTED]
    pilot.run(3.0)
    assert not pilot.is_armed()
    ahead_later_m, above_later_m = on_deck_m(pilot)
    assert abs(ahead_later_m - ahead_m) < 0.1
    assert above_later_m == pytest.approx(0.12, abs=0.01)


@pytest.mark.slow
def test_a_moving_deck_is_never_taken_for_a_landing() -> None:
    pilot = Pilot(deck=deck)
    landed_on_the_roof(pilot)
    pilot.run(
        12.0,
        lambda t: setpoint((vehicle_y_m(t), 0.0, 0.5 - ROOF_M), (SPEED_M_S, 0.0, 0.5), mask=POSITION_VELOCITY),
    )
    assert pilot.is_armed()
    assert mavlink.MAV_LANDED_STATE_ON_GROUND not in {
        message.landed_state for t_s, message in pilot.received if t_s > BEGINS_S and hasattr(message, "landed_state")
    }


@pytest.mark.slow
def test_with_the_detectors_speed_limit_raised_it_lands_on_the_moving_deck_by_itself() -> None:
    pilot = Pilot(px4(parameters={"LNDMC_XY_VEL_MAX": 10.0}), deck=deck)
    landed_on_the_roof(pilot)

    def press(t_s: float) -> Message:
        return setpoint((vehicle_y_m(t_s), 0.0, 0.5 - ROOF_M), (SPEED_M_S, 0.0, 0.5), mask=POSITION_VELOCITY)

    to_landed_s = 1.0 + pilot.run_until(lambda: pilot.node.memory.course.landing.landed, 5.0, press)
    to_disarmed_s = pilot.run_until(lambda: not pilot.is_armed(), 5.0, press)
    assert to_landed_s == pytest.approx(1.5, abs=0.5)  # measured on PX4
    assert to_disarmed_s == pytest.approx(2.0, abs=0.1)
    assert on_deck_m(pilot)[1] == pytest.approx(0.12, abs=0.01)


@pytest.mark.slow
def test_the_range_finder_measures_to_the_roof_while_it_is_over_it() -> None:
    pilot = Pilot(deck=deck)
    landed_on_the_roof(pilot)
    pilot.run(0.1)
    assert pilot.last("DISTANCE_SENSOR").current_distance == pytest.approx(12, abs=3)
