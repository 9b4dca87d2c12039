"""Which driver flies which autopilot, and what is refused."""

import pytest

from companion.autopilots.choice import driver_for
from link.errors import UserError
from link.mavlink.dialect import mavlink

PX4 = mavlink.MAV_AUTOPILOT_PX4
OTHERS = [
    mavlink.MAV_TYPE_FIXED_WING,
    mavlink.MAV_TYPE_GROUND_ROVER,
    mavlink.MAV_TYPE_HELICOPTER,
    mavlink.MAV_TYPE_VTOL_TILTROTOR,
    mavlink.MAV_TYPE_GCS,
]


@pytest.mark.parametrize("vehicle_type", OTHERS)
def test_what_is_no_multirotor_is_refused_in_one_line(vehicle_type: int) -> None:
    with pytest.raises(UserError, match=f"MAV_TYPE {vehicle_type}, which is no multirotor") as error:
        driver_for(PX4, vehicle_type)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("autopilot_id", [mavlink.MAV_AUTOPILOT_GENERIC, mavlink.MAV_AUTOPILOT_INVALID, 255])
def test_unknown_autopilot_is_refused_and_the_known_ones_are_named(autopilot_id: int) -> None:
    with pytest.raises(UserError, match="px4"):
        driver_for(autopilot_id, mavlink.MAV_TYPE_QUADROTOR)
