"""One step of the simulated autopilot: messages in, 10 ms of flight, messages out.

Order of a step: obey what was received, look after modes and motors, fly to `t_ns`, report the state then.
"""

from itertools import repeat

import numpy as np

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.incoming import take
from sim_autopilot.commands.reboot import rebooted
from sim_autopilot.files_step import log_flight, send_log, send_on
from sim_autopilot.flight.flight import is_takeoff_complete
from sim_autopilot.flight.land_detector import detect_landing
from sim_autopilot.flight.manual import are_held
from sim_autopilot.flight.mode_change import change_mode
from sim_autopilot.flight.modes import Event, Mode
from sim_autopilot.flight.steering import over_target, steer
from sim_autopilot.log_stream_step import stream_log
from sim_autopilot.memory import (
    AutopilotConfig,
    AutopilotInputs,
    AutopilotMemory,
    AutopilotOutputs,
)
from sim_autopilot.memory_links import at_link, text_links
from sim_autopilot.missions.step import advance_mission, pass_transfer
from sim_autopilot.origin import step_origin
from sim_autopilot.parameters import parameter_message
from sim_autopilot.plant import asked_tilt_rad, fly
from sim_autopilot.safety.arming import disarm, should_disarm
from sim_autopilot.safety.failsafes_step import keep_watch, mind_lost_sticks
from sim_autopilot.safety.failures import stopped
from sim_autopilot.setpoints.setpoints import are_fresh
from sim_autopilot.snapshot import take_snapshot
from sim_autopilot.streams import due_messages
from sim_autopilot.telemetry.builders import build_message
from sim_autopilot.telemetry.chart import near
from sim_autopilot.telemetry.events import failsafe_texts, tell
from sim_autopilot.telemetry.status import heartbeat
from sim_autopilot.telemetry.tidings import announcement, changes_told

_LISTED_A_STEP = 10
"""Parameters of a list sent in 10 ms: all of them within a second or two, as the real ones send them over UDP."""
_Sent = tuple[Message, int | None]
"""A message and the link that it goes to; None as in `AutopilotOutputs`."""


def autopilot_step(
    memory: AutopilotMemory, inputs: AutopilotInputs, config: AutopilotConfig
) -> tuple[AutopilotMemory, AutopilotOutputs]:
    """Return the autopilot at `inputs.t_ns`, what it sends then, and the true state.

    Args:
        memory: after the last step.
        inputs: received since then; its time is one or more control periods later.
        config: what does not change.
    """
    memory = rebooted(memory, config)
    start = memory
    replies: list[_Sent] = []
    for message, link in zip(inputs.messages, inputs.links or repeat(0), strict=False):
        memory, answers = take(at_link(memory, link), message, config)
        replies += [(answer, link) for answer in answers]
    # What concerns nobody in particular is told as on the first link that wants texts.
    texted = text_links(memory)
    memory = at_link(memory, texted[0] if texted else 0)
    messages: list[Message] = []
    was_ns = memory.now.boot_ns
    obeyed = memory
    memory, served = _serve(_supervise(memory, config), config)
    messages += served
    memory, warned = _warn(obeyed, memory, config)
    messages += warned
    memory = _after_flight(_advance(memory, inputs, config))
    memory, told = step_origin(memory, was_ns, config)
    messages += told
    if _origin_came(was_ns, memory.now.boot_ns, config):
        messages += announcement(memory, config, with_home=config.firmware.announces_home)
    if config.firmware.tells_modes and memory.modes.mode is not start.modes.mode:
        messages.append(heartbeat(memory, config))
    memory, told = changes_told(start, obeyed, memory, config)
    messages += told
    memory, late = _late_answers(memory)
    messages += late
    reports: list[_Sent] = []
    for link in range(len(memory.links)):
        memory, own = _reports(at_link(memory, link), config)
        reports += [(report, link) for report in own]
    sent = [*replies, *_to_all(messages, texted), *reports]
    return memory, AutopilotOutputs(
        messages=tuple(message for message, _ in sent),
        links=tuple(link for _, link in sent),
        state=memory.plant.state,
    )


def _to_all(messages: list[Message], texted: tuple[int, ...]) -> list[_Sent]:
    """Send texts to the links that want them and everything else to wherever it belongs."""
    sent: list[_Sent] = []
    for message in messages:
        is_text = message.get_msgId() == mavlink.MAVLINK_MSG_ID_STATUSTEXT
        sent += [(message, link) for link in texted] if is_text else [(message, None)]
    return sent


def _supervise(memory: AutopilotMemory, config: AutopilotConfig) -> AutopilotMemory:
    """Look after lost setpoints and motors that run for nothing."""
    if memory.armed_ns is None:
        return memory
    settings = memory.settings
    lost = not are_fresh(memory.setpoints, memory.now.boot_ns, settings.setpoint_loss_s)
    if lost and memory.modes.mode is Mode.OFFBOARD and not config.firmware.guided:
        if settings.setpoint_loss_event is None:
            return disarm(memory)
        memory = change_mode(memory, settings.setpoint_loss_event)
    memory = _mind_sticks(memory)
    return disarm(memory) if should_disarm(memory) else memory


def _mind_sticks(memory: AutopilotMemory) -> AutopilotMemory:
    """Look after sticks that were let go of, and after a pilot who takes over by moving them."""
    sticks, settings, mode = memory.services.sticks, memory.settings, memory.modes.mode
    if sticks is None:
        return memory
    held = are_held(sticks, memory.now.boot_ns, settings.sticks)
    memory = mind_lost_sticks(memory, held=held)
    if not held:
        return memory
    moved = sticks.moved_per_s > settings.sticks_moved_per_s and not memory.landing.landed
    return change_mode(memory, Event.ASK_POSITION) if moved and mode in settings.overridden_modes else memory


def _serve(memory: AutopilotMemory, config: AutopilotConfig) -> tuple[AutopilotMemory, tuple[Message, ...]]:
    """Keep watch, and go on with a transfer and with the mission."""
    memory, asked = pass_transfer(keep_watch(memory, config), config)
    memory, told = advance_mission(memory, config)
    memory, sent = send_on(log_flight(memory, config), config)
    return memory, asked + told + sent


def _warn(
    before: AutopilotMemory, memory: AutopilotMemory, config: AutopilotConfig
) -> tuple[AutopilotMemory, tuple[Message, ...]]:
    """Say what the failsafes have noticed and done."""
    texts, messages = config.firmware.texts, ()
    for text, code in failsafe_texts(before, memory, texts.battery, texts.failsafe):
        telling = tell(memory, text, texts.severity, config, code)
        memory, messages = telling.memory, (*messages, *telling.messages)
    return memory, messages


def _advance(memory: AutopilotMemory, inputs: AutopilotInputs, config: AutopilotConfig) -> AutopilotMemory:
    """Fly to the step's end."""
    duration_s = (inputs.t_ns - memory.now.t_ns) * 1e-9
    steering = steer(memory, config, duration_s)
    plant_config = memory.plant_config
    error = inputs.own_error
    wind_enu_m_s = inputs.wind_enu_m_s + np.array(memory.settings.wind_enu_m_s)
    memory, following = over_target(memory, steering.following, duration_s)
    plant = fly(memory.plant, following, inputs.deck, wind_enu_m_s, plant_config, duration_s, error)
    east, north, up = wind_enu_m_s.tolist()
    plant = stopped(plant, memory.services.failures)
    now = take_snapshot(plant.state, plant_config.airframe, plant.state.t_ns - memory.start_ns, error)
    return replace(
        memory,
        plant=plant,
        now=now,
        flight=steering.flight,
        guided=steering.guided,
        climb=steering.climb,
        landing=steering.landing,
        following=following,
        deck=inputs.deck,
        wind_enu_m_s=(east, north, up),
        chart=near(memory.chart, now.position_enu_m),
    )


def _after_flight(memory: AutopilotMemory) -> AutopilotMemory:
    """Look after a landing and the end of a take-off."""
    if memory.armed_ns is None:
        return memory
    landing, now = memory.landing, memory.now
    if landing.landed or memory.climb is not None:
        return memory
    tilt_rad = asked_tilt_rad(memory.plant, memory.following)
    landing = detect_landing(landing, now, memory.following, memory.settings, tilt_rad)
    if landing != memory.landing:
        memory = replace(memory, landing=landing)
    if memory.modes.mode is Mode.TAKEOFF and is_takeoff_complete(memory.flight, now, memory.settings):
        memory = replace(change_mode(memory, Event.TAKEOFF_COMPLETE), flight=memory.flight)
        modes = memory.modes
        return memory if modes.resting is None else replace(memory, modes=replace(modes, resting=modes.mode))
    return memory


def _late_answers(memory: AutopilotMemory) -> tuple[AutopilotMemory, list[Message]]:
    """Return the answers put off until now."""
    if not memory.later:
        return memory, []
    boot_ns = memory.now.boot_ns
    messages = [later.message for later in memory.later if later.boot_ns <= boot_ns]
    later = tuple(later for later in memory.later if later.boot_ns > boot_ns)
    return replace(memory, later=later), messages


def _reports(memory: AutopilotMemory, config: AutopilotConfig) -> tuple[AutopilotMemory, list[Message]]:
    """Return what the link at hand sends of itself: the next parameters of a list under way, and what streams."""
    messages: list[Message] = []
    streams, due = due_messages(memory.streams, memory.now.boot_ns)
    if memory.listing is not None:
        parameters, first = config.firmware.parameters, memory.listing
        end = min(first + _LISTED_A_STEP, len(parameters))
        autopilot_id = config.firmware.autopilot_id
        messages += [parameter_message(parameters, index, memory.values, autopilot_id) for index in range(first, end)]
        memory = replace(memory, listing=end if end < len(parameters) else None)
    if due:
        memory = replace(memory, streams=streams)
    memory, log = send_log(memory, config)
    memory, live = stream_log(memory, config)
    messages += log + live
    reports = (build_message(config.firmware.streams[message_id], memory, config) for message_id in due)
    return memory, messages + [report for report in reports if report is not None]


def _origin_came(was_ns: int, now_ns: int, config: AutopilotConfig) -> bool:
    """Whether the origin has just become known, when it is sent once unasked."""
    came_ns = 0 if config.instant else round(config.firmware.readiness.position_s * 1e9)
    return was_ns < came_ns <= now_ns or (came_ns == 0 and was_ns == 0)
