from math import nan, radians
from operator import attrgetter

import pytest

from link.mavlink.dialect import Message, mavlink
from link.mavlink.parameters import parameter_on_wire, parameter_value
from sim_autopilot.core.modes import Event
from sim_autopilot.core.parameters import default_values
from sim_autopilot.firmware.px4.parameters import OBEYED
from sim_autopilot.firmware.px4.px4 import PX4
from tests.sim_autopilot.pilot import Pilot, px4

REAL, INTEGER = mavlink.MAV_PARAM_TYPE_REAL32, mavlink.MAV_PARAM_TYPE_INT32


def set_parameter(name: str, value: float, kind: int) -> Message:
    wire = parameter_on_wire(value, kind, mavlink.MAV_AUTOPILOT_PX4)
    return mavlink.MAVLink_param_set_message(1, 1, name.encode(), wire, kind)


def values(pilot: Pilot) -> dict[str, float | int | None]:
    return {m.param_id: parameter_value(m, mavlink.MAV_AUTOPILOT_PX4) for m in pilot.all("PARAM_VALUE")}


def test_a_list_brings_every_parameter_once_in_order() -> None:
    pilot = Pilot()
    pilot.step(mavlink.MAVLink_param_request_list_message(1, 1))
    pilot.run(1.0)
    sent = pilot.all("PARAM_VALUE")
    assert [message.param_index for message in sent] == list(range(len(PX4.parameters.table)))
    assert {message.param_count for message in sent} == {len(PX4.parameters.table)}


def test_every_parameter_changes_how_it_flies() -> None:
    defaults = default_values(PX4.parameters.table, {})
    unchanged = PX4.parameters.settings(defaults)
    for parameter in OBEYED:
        other = parameter.lowest + 0.37 * (parameter.highest - parameter.lowest)
        if parameter.is_integer:
            other = parameter.highest if parameter.highest != parameter.default else parameter.lowest
        assert PX4.parameters.settings({**defaults, parameter.name: other}) != unchanged, parameter.name


def test_a_set_parameter_acts_at_once_and_is_answered() -> None:
    pilot = Pilot()
    pilot.step(set_parameter("MPC_XY_VEL_MAX", 17.5, REAL), set_parameter("MPC_TILTMAX_AIR", 33.0, REAL))
    assert values(pilot) == {"MPC_XY_VEL_MAX": 17.5, "MPC_TILTMAX_AIR": 33.0}
    envelope = pilot.node.memory.tuning.plant_config.envelope
    assert envelope.speed_max_m_s == 17.5
    assert envelope.tilt_max_rad == pytest.approx(radians(33.0))


def test_an_integer_travels_bytewise() -> None:
    pilot = Pilot()
    pilot.step(set_parameter("COM_OBL_RC_ACT", 4, INTEGER))
    assert values(pilot) == {"COM_OBL_RC_ACT": 4}
    assert pilot.last("PARAM_VALUE").param_value == pytest.approx(4 * 2.0**-149)


def test_a_value_that_is_no_number_leaves_the_parameter_and_tells_its_value() -> None:
    pilot = Pilot()
    pilot.step(set_parameter("MPC_XY_VEL_MAX", nan, REAL))
    assert values(pilot) == {"MPC_XY_VEL_MAX": 12.0}


@pytest.mark.parametrize(
    ("name", "value", "kind", "setting", "flown"),
    [
        ("MPC_XY_VEL_MAX", -1.0, REAL, "envelope.speed_max_m_s", 0.1),
        ("MPC_XY_VEL_MAX", 1e9, REAL, "envelope.speed_max_m_s", 40.0),
        ("COM_OBL_RC_ACT", 99, INTEGER, "setpoints.loss_event", Event.LOST_TO_POSITION),
    ],
)
def test_a_value_out_of_its_range_is_kept_and_told_and_the_flight_stays_within(
    name: str, value: float, kind: int, setting: str, flown: object
) -> None:
    pilot = Pilot()
    pilot.step(set_parameter(name, value, kind))
    assert values(pilot) == {name: value}
    assert attrgetter(setting)(pilot.node.memory.tuning.settings) == flown


def test_a_set_of_another_type_than_the_parameters_is_not_answered() -> None:
    pilot = Pilot()
    pilot.step(set_parameter("MPC_XY_VEL_MAX", 5, INTEGER), set_parameter("COM_OBL_RC_ACT", 3.0, REAL))
    assert not pilot.all("PARAM_VALUE")


def test_a_parameter_that_nothing_obeys_is_kept_all_the_same() -> None:
    pilot = Pilot(px4(system_id=3))
    read = mavlink.MAVLink_param_request_read_message(3, 1, b"MAV_SYS_ID", -1)
    stored = mavlink.MAVLink_param_set_message(3, 1, b"BAT1_N_CELLS", parameter_on_wire(-1, INTEGER, 12), INTEGER)
    pilot.step(read, stored)
    assert values(pilot) == {"MAV_SYS_ID": 3, "BAT1_N_CELLS": -1}


def test_an_unknown_parameter_is_not_answered() -> None:
    pilot = Pilot()
    pilot.step(
        mavlink.MAVLink_param_request_read_message(1, 1, b"NO_SUCH_NAME", -1),
        mavlink.MAVLink_param_request_read_message(1, 1, b"", 5000),
        set_parameter("NO_SUCH_NAME", 1.0, REAL),
        mavlink.MAVLink_param_request_read_message(2, 1, b"MPC_XY_VEL_MAX", -1),
    )
    assert not pilot.all("PARAM_VALUE")


def test_the_configuration_sets_parameters_and_refuses_wrong_ones() -> None:
    assert Pilot(px4(parameters={"COM_OF_LOSS_T": 0.5})).node.memory.tuning.settings.setpoints.loss_s == 0.5
    with pytest.raises(ValueError, match="no parameter COM_OF_LOST_T"):
        Pilot(px4(parameters={"COM_OF_LOST_T": 0.5}))
    with pytest.raises(ValueError, match=r"COM_OF_LOSS_T = -1\.0 is not between"):
        Pilot(px4(parameters={"COM_OF_LOSS_T": -1.0}))
