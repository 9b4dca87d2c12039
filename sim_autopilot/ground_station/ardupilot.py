"""ArduCopter's services."""

from functools import partial
from types import MappingProxyType

from link.ftp.state import FtpRules
from link.ftp.store import Shown
from link.ftp.wire import DATA_MAX, Error
from link.mavlink.dialect import mavlink
from sim_autopilot.core.parameters import Parameter, Values
from sim_autopilot.ground_station.calibration import accept_calibration
from sim_autopilot.ground_station.fixed_answers import ARDUCOPTER_ANSWERS
from sim_autopilot.ground_station.logs.flight_log import LogRules, dataflash_head, dataflash_row
from sim_autopilot.ground_station.maintenance import (
    format_storage,
    reset_parameters,
    send_banner,
    send_version,
    set_servo,
    spin_motor,
)
from sim_autopilot.ground_station.missions.rules import ARDUCOPTER_MISSIONS
from sim_autopilot.ground_station.parameter_file import PATH, pack_parameters
from sim_autopilot.ground_station.station import GroundStation


def _shown_files(parameters: tuple[Parameter, ...], values: Values) -> Shown:
    return {
        PATH: partial(pack_parameters, parameters, values),
        f"{PATH}?withdefaults=1": partial(pack_parameters, parameters, values, with_defaults=True),
    }


_FTP = FtpRules(
    own_session=False,
    busy=Error.FAIL,
    not_open=Error.FILE_NOT_FOUND,
    unknown=Error.FAIL,
    idle_s=3.0,
    burst_bytes=500 * DATA_MAX,
    burst_of_any_size=True,
    truncates=False,
    entry_end=b"\0\0",
    names_itself=False,
)
_LOGS = LogRules(
    head=dataflash_head,
    row=dataflash_row,
    first_id=1,
    told_empty=True,
    only_disarmed="Disarm for log download",
    path="logs/{1:08d}.BIN",
)
ARDUPILOT_STATION = GroundStation(
    files=_shown_files,
    ftp=_FTP,
    logs=_LOGS,
    plans=ARDUCOPTER_MISSIONS,
    messages=MappingProxyType({mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION_REQUEST: send_version}),
    commands=MappingProxyType(
        {
            mavlink.MAV_CMD_PREFLIGHT_CALIBRATION: accept_calibration,
            mavlink.MAV_CMD_DO_SET_SERVO: set_servo,
            mavlink.MAV_CMD_DO_REPEAT_SERVO: set_servo,
            mavlink.MAV_CMD_DO_MOTOR_TEST: spin_motor,
            mavlink.MAV_CMD_PREFLIGHT_STORAGE: reset_parameters,
            mavlink.MAV_CMD_DO_SEND_BANNER: send_banner,
            mavlink.MAV_CMD_STORAGE_FORMAT: format_storage,
        }
    ),
    fixed_answers=ARDUCOPTER_ANSWERS,
)
