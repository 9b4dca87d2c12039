from math import nan

import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.parameters import default_values
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from tests.sim_autopilot.copter import ardupilot
from tests.sim_autopilot.pilot import DATUM, Pilot

REAL32, INT16, INT8 = 9, 4, 2


def answers(pilot: Pilot, message: Message) -> list[Message]:
    before = len(pilot.received)
    pilot.step(message)
    pilot.run(0.05)
    return [reply for _, reply in pilot.received[before:] if reply.get_type() == "PARAM_VALUE"]


def read(name: str) -> Message:
    return mavlink.MAVLink_param_request_read_message(1, 1, name.encode(), -1)


def put(name: str, value: float, kind: int = REAL32) -> Message:
    return mavlink.MAVLink_param_set_message(1, 1, name.encode(), value, kind)


@pytest.mark.parametrize(
    ("name", "value", "kind"),
    [("ANGLE_MAX", 3000.0, INT16), ("WPNAV_SPEED", 1000.0, REAL32), ("DISARM_DELAY", 10.0, INT8)],
)
def test_a_parameter_travels_as_a_plain_float_whatever_its_type(name: str, value: float, kind: int) -> None:
    (answer,) = answers(Pilot(ardupilot()), read(name))
    assert (answer.param_id, answer.param_value, answer.param_type) == (name, value, kind)
    assert (answer.param_count, answer.param_index) == (len(ARDUPILOT.parameters.table), 65535)


def test_an_unknown_parameter_is_not_answered() -> None:
    pilot = Pilot(ardupilot())
    assert answers(pilot, read("MPC_XY_VEL_MAX")) == []
    assert answers(pilot, put("NO_SUCH_PARAM", 1.0)) == []


@pytest.mark.parametrize(
    ("value", "kept"), [(4500.0, 4500.0), (4500.4, 4500.0), (1e9, 32767.0), (nan, 3000.0)], ids=str
)
def test_a_set_takes_any_number_of_any_type_and_makes_it_fit(value: float, kept: float) -> None:
    (answer,) = answers(Pilot(ardupilot()), put("ANGLE_MAX", value, REAL32))
    assert (answer.param_value, answer.param_type) == (kept, INT16)


def test_parameters_set_in_flight_change_what_the_flight_keeps_to() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(put("WPNAV_SPEED", 700.0), put("GUID_TIMEOUT", 1.5))
    pilot.step()
    path = pilot.node.memory.tuning.settings.path
    assert path is not None
    assert (path.speed_m_s, path.timeout_s) == (7.0, 1.5)


def test_absurd_values_leave_settings_that_can_be_flown() -> None:
    for value in (-1e30, 0.0, 1e30):
        values = dict.fromkeys(default_values(ARDUPILOT.parameters.table, {}), value)
        settings = ARDUPILOT.parameters.settings(values)
        assert settings.path is not None
        assert settings.path.acceleration_m_s2 > 0.0
        assert settings.path.jerk_m_s3 > 0.0
        assert 0.1 < settings.envelope.tilt_max_rad < 1.5
        assert settings.envelope.yaw_rate_max_rad_s > 0.0


def test_every_default_is_inside_its_own_range_and_fits_its_name() -> None:
    for parameter in ARDUPILOT.parameters.table:
        assert parameter.lowest <= parameter.default <= parameter.highest
        assert len(parameter.name) <= 16
    assert len({parameter.name for parameter in ARDUPILOT.parameters.table}) == len(ARDUPILOT.parameters.table)


def test_the_origin_moves_no_more_once_it_is_there() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mavlink.MAVLink_set_gps_global_origin_message(1, 524_740_000, 134_020_000, 90_000))
    pilot.step()
    assert pilot.node.memory.places.origin.frame.origin == DATUM
