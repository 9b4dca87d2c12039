"""PX4's services."""

from types import MappingProxyType

from link.ftp.state import FtpRules
from link.mavlink.dialect import COMPONENT_METADATA_ID, mavlink
from sim_autopilot.core.streams import Stream
from sim_autopilot.firmware.px4.flight_texts import LOG_PATH
from sim_autopilot.ground_station.calibration import calibrate
from sim_autopilot.ground_station.fixed_answers import PX4_ANSWERS
from sim_autopilot.ground_station.gripper import grip
from sim_autopilot.ground_station.log_streaming import start_log_stream, stop_log_stream
from sim_autopilot.ground_station.logs.flight_log import LogRules, ulog_head, ulog_row
from sim_autopilot.ground_station.missions.rules import PX4_MISSIONS
from sim_autopilot.ground_station.px4.arming_report import report_arming
from sim_autopilot.ground_station.px4.available_modes import request_modes
from sim_autopilot.ground_station.px4.component_metadata import component_metadata, shown_files
from sim_autopilot.ground_station.px4.maintenance import actuator_test, store_parameters
from sim_autopilot.ground_station.shell import take_typed
from sim_autopilot.ground_station.station import GroundStation

_LOGS = LogRules(
    head=ulog_head,
    row=ulog_row,
    first_id=0,
    told_empty=False,
    only_disarmed="",
    path=LOG_PATH,
)
PX4_STATION = GroundStation(
    files=shown_files,
    ftp=FtpRules(),
    logs=_LOGS,
    plans=PX4_MISSIONS,
    messages=MappingProxyType({mavlink.MAVLINK_MSG_ID_SERIAL_CONTROL: take_typed}),
    commands=MappingProxyType(
        {
            mavlink.MAV_CMD_REQUEST_MESSAGE: request_modes,
            mavlink.MAV_CMD_RUN_PREARM_CHECKS: report_arming,
            mavlink.MAV_CMD_LOGGING_START: start_log_stream(_LOGS),
            mavlink.MAV_CMD_LOGGING_STOP: stop_log_stream,
            mavlink.MAV_CMD_DO_GRIPPER: grip,
            mavlink.MAV_CMD_PREFLIGHT_CALIBRATION: calibrate,
            mavlink.MAV_CMD_PREFLIGHT_STORAGE: store_parameters,
            mavlink.MAV_CMD_ACTUATOR_TEST: actuator_test,
        }
    ),
    fixed_answers=PX4_ANSWERS,
    streams=MappingProxyType({COMPONENT_METADATA_ID: Stream(message_id=COMPONENT_METADATA_ID)}),
    builders=MappingProxyType({COMPONENT_METADATA_ID: component_metadata}),
)
