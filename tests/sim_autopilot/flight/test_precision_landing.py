from collections.abc import Callable
from math import atan, hypot

import pytest

from link.frames.rotations import conjugate, frd_from_flu, rotate
from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.copter import LAND, ardupilot, copter_in_the_air, mode
from tests.sim_autopilot.pilot import Pilot

pytestmark = pytest.mark.slow

PLND = {"PLND_ENABLED": 1.0, "PLND_TYPE": 1.0}
BODY, LOCAL = int(mavlink.MAV_FRAME_BODY_FRD), int(mavlink.MAV_FRAME_LOCAL_NED)


def seen(pilot: Pilot, place: tuple[float, float, float], *, valid: int = 1, frame: int = BODY) -> Message:
    """A LANDING_TARGET as a camera on the drone makes it."""
    state = pilot.node.state
    w, x, y, z = state.orientation_wxyz.tolist()
    px, py, pz = state.position_enu_m.tolist()
    arm = frd_from_flu(rotate(conjugate((w, x, y, z)), (place[0] - px, place[1] - py, place[2] - pz)))
    angles = (0.0, 0.0) if valid else (atan(arm[1] / arm[2]), -atan(arm[0] / arm[2]))
    distance = hypot(*arm) if valid else 0.0
    q = (1.0, 0.0, 0.0, 0.0)
    return mavlink.MAVLink_landing_target_message(0, 0, frame, *angles, distance, 0, 0, *arm, q, 2, valid)


def landing(duration_s: float, make: Callable[[Pilot, float], Message], **parameters: float) -> Pilot:
    pilot = copter_in_the_air(ardupilot(parameters={**PLND, **parameters}), 8.0)
    pilot.step(mode(LAND))
    began_s = pilot.t_s
    pilot.run(duration_s, lambda t_s: make(pilot, t_s - began_s))
    return pilot


@pytest.mark.parametrize("valid", [1, 0])
def test_land_goes_to_a_target_seen_by_position_or_by_angles(valid: int) -> None:
    pilot = landing(6.0, lambda pilot, _t: seen(pilot, (1.5, -1.0, 0.0), valid=valid))
    assert pilot.position[:2] == pytest.approx((1.5, -1.0), abs=0.05)


def test_a_target_of_2_m_s_is_followed_within_3_cm() -> None:
    pilot = landing(9.0, lambda pilot, t: seen(pilot, (0.0, 2.0 * t, 0.0)), PLND_OPTIONS=1.0, LAND_ALT_LOW=1000.0)
    pilot.step(seen(pilot, (0.0, 18.0, 0.0)))
    assert hypot(pilot.position[0], pilot.position[1] - 18.0) < 0.03
    assert pilot.node.state.velocity_enu_m_s[1] == pytest.approx(2.0, abs=0.03)


def test_a_target_far_to_the_side_is_reached_before_it_sinks() -> None:
    pilot = landing(1.5, lambda pilot, _t: seen(pilot, (6.0, 0.0, 0.0)))
    assert pilot.position[2] == pytest.approx(8.0, abs=0.25)


@pytest.mark.parametrize(("parameters", "frame"), [({}, LOCAL), ({"PLND_ENABLED": 0.0}, BODY)])
def test_a_target_in_another_frame_or_unasked_for_is_not_followed(parameters: dict[str, float], frame: int) -> None:
    pilot = landing(3.0, lambda pilot, _t: seen(pilot, (1.5, -1.0, 0.0), frame=frame), **parameters)
    assert hypot(*pilot.position[:2]) < 0.2


def test_a_drone_that_was_held_up_over_its_target_sinks_on_no_faster_than_land_does() -> None:
    pilot = landing(0.1, lambda pilot, _t: seen(pilot, (0.3, 0.0, 0.0)))
    sinks_m_s = []
    while pilot.position[2] > 0.2:
        pilot.run(0.02, lambda _t: seen(pilot, (pilot.position[0] + 0.1, 0.0, 0.0)))
        sinks_m_s.append(-pilot.node.state.velocity_enu_m_s[2])
    assert max(sinks_m_s) < 0.6
