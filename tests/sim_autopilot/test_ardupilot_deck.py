"""ArduCopter comes down on a moving deck, against what was measured on the real one."""

from collections.abc import Callable

import numpy as np
import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.data import Deck, Surface
from sim_autopilot.physics.airframe import ARDUCOPTER_AIRFRAME
from sim_autopilot.plant.config import PlantConfig
from tests.sim_autopilot.copter import GUIDED, LAND, ardupilot, every, mode, take_off
from tests.sim_autopilot.pilot import START_NS, Pilot, arm

pytestmark = pytest.mark.slow

ACCEPTED, FAILED = 0, 4
FOLLOW = 0b1001_1100_0000
ROOF_M = 1.5
BEGINS_S = 12.0
EXTENDED_SYS_STATE = 245


def vehicle(speed_m_s: float) -> Callable[[float], float]:
    return lambda t_s: speed_m_s * (t_s - BEGINS_S)


def deck(speed_m_s: float) -> Callable[[int], Deck]:
    """A vehicle on the way north that passes the origin."""
    y_m = vehicle(speed_m_s)

    def at(t_ns: int) -> Deck:
        return Deck(
            t_ns=t_ns,
            position_enu_m=np.array((0.0, y_m((t_ns - START_NS) * 1e-9), 0.0)),
            orientation_wxyz=np.array((np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))),
            velocity_enu_m_s=np.array((0.0, speed_m_s, 0.0)),
            angular_velocity_enu_rad_s=np.zeros(3),
            roof_size_m=(4.2, 1.8),
            roof_height_m=ROOF_M,
        )

    return at


def chase(pilot: Pilot, speed_m_s: float, height_m: float, sink_m_s: float) -> Message:
    north_m = vehicle(speed_m_s)(pilot.t_s + 0.01)
    return mavlink.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, 1, FOLLOW, north_m, 0.0, -height_m, speed_m_s, 0.0, sink_m_s, 0.0, 0.0, 0.0, 0.0, 0.0
    )


def above_the_roof(speed_m_s: float) -> Pilot:
    """A pilot that has taken off and caught up with the vehicle, 2 m above its roof."""
    pilot = Pilot(ardupilot(plant=PlantConfig(airframe=ARDUCOPTER_AIRFRAME)), deck=deck(speed_m_s))
    pilot.step(mode(GUIDED), arm(), every(EXTENDED_SYS_STATE, 50.0))
    take_off(pilot, 5.0)
    pilot.run_until(lambda: pilot.t_s > BEGINS_S, 20.0)
    pilot.run(12.0, lambda _: chase(pilot, speed_m_s, 3.5, 0.0))
    return pilot


def pressed_on(pilot: Pilot, speed_m_s: float) -> None:
    """Sink on until contact."""
    began_s = pilot.t_s

    def sinking(t_s: float) -> Message:
        return chase(pilot, speed_m_s, 3.5 - 0.5 * (t_s - began_s), 0.5)

    pilot.run_until(lambda: pilot.node.state.surface is Surface.DECK, 10.0, sinking)


def landed_state(pilot: Pilot) -> int:
    return int(pilot.last("EXTENDED_SYS_STATE").landed_state)


@pytest.mark.parametrize("speed_m_s", [3.0, 5.0])
def test_descending_on_in_guided_it_is_landed_1_4_s_after_contact_and_disarms_plainly(speed_m_s: float) -> None:
    pilot = above_the_roof(speed_m_s)
    pressed_on(pilot, speed_m_s)
    ahead_m = pilot.position[1] - vehicle(speed_m_s)(pilot.t_s)
    assert abs(ahead_m) < 0.3
    assert pilot.acknowledged(arm(armed=False)) == [FAILED]
    waited_s = pilot.run_until(
        lambda: landed_state(pilot) == mavlink.MAV_LANDED_STATE_ON_GROUND,
        10.0,
        lambda _: chase(pilot, speed_m_s, ROOF_M - 0.5, 0.5),
    )
    assert waited_s == pytest.approx(1.4, abs=0.6)
    assert pilot.acknowledged(arm(armed=False)) == [ACCEPTED]
    assert not pilot.is_armed()


def test_at_8_m_s_the_tilt_that_is_asked_for_blocks_the_land_detector_and_force_disarm_works() -> None:
    pilot = above_the_roof(8.0)
    pressed_on(pilot, 8.0)
    pilot.run(5.0, lambda _: chase(pilot, 8.0, ROOF_M - 0.5, 0.5))
    assert landed_state(pilot) == mavlink.MAV_LANDED_STATE_IN_AIR
    assert pilot.acknowledged(arm(armed=False)) == [FAILED]
    assert pilot.acknowledged(arm(armed=False, force=True)) == [ACCEPTED]


def test_land_mode_on_a_moving_deck_brakes_and_falls_behind() -> None:
    pilot = above_the_roof(5.0)
    pilot.step(mode(LAND))
    pilot.run(6.0)
    assert vehicle(5.0)(pilot.t_s) - pilot.position[1] > 10.0
    assert landed_state(pilot) == mavlink.MAV_LANDED_STATE_LANDING
    assert pilot.node.state.surface is not Surface.DECK
