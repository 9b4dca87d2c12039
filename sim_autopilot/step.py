"""One step of the simulated autopilot: messages in, 10 ms of flight, messages out.

Order of a step: obey what was received, look after modes and motors, fly to `t_ns`, report the state then.
"""

from itertools import repeat

import numpy as np

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.boot import reboot_if_due
from sim_autopilot.commands.incoming import take
from sim_autopilot.commands.origin import step_origin
from sim_autopilot.core.data import Deck
from sim_autopilot.core.modes import Event, Mode
from sim_autopilot.core.parameters import parameter_message
from sim_autopilot.core.places import near
from sim_autopilot.core.streams import due_messages
from sim_autopilot.flight.flight import is_takeoff_complete
from sim_autopilot.flight.land_detector import detect_landing
from sim_autopilot.flight.manual import are_held
from sim_autopilot.flight.mode_change import change_mode
from sim_autopilot.flight.steering import over_target, steer
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import (
    AutopilotInputs,
    AutopilotMemory,
    AutopilotOutputs,
    World,
    at_link,
    with_flight,
    with_link,
)
from sim_autopilot.missions.step import advance_mission
from sim_autopilot.plant.plant import asked_tilt_rad, fly
from sim_autopilot.plant.snapshot import take_snapshot
from sim_autopilot.safety.arming import disarm, should_disarm
from sim_autopilot.safety.failsafes_step import keep_watch, mind_lost_sticks
from sim_autopilot.safety.failures import stop_failed
from sim_autopilot.telemetry.builders import build_message, stream_of
from sim_autopilot.telemetry.events import announce_origin, describe_step, failsafe_texts, tell
from sim_autopilot.telemetry.status import heartbeat

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
    memory = reboot_if_due(memory, config)
    start = memory
    memory, replies = _obey(memory, inputs, config)
    # What concerns nobody in particular is told as on the first link that wants texts.
    texted = memory.links.texted
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
        messages += announce_origin(memory, config, with_home=config.firmware.origin.announces_home)
    if config.firmware.modes.tells_changes and memory.modes.mode is not start.modes.mode:
        messages.append(heartbeat(memory, config))
    memory, told = describe_step(start, obeyed, memory, config)
    messages += told
    memory, late = _late_answers(memory)
    messages += late
    memory, reports = _report_on_each_link(memory, config)
    sent = [*replies, *_to_all(messages, texted), *reports]
    return memory, AutopilotOutputs(
        messages=tuple(message for message, _ in sent),
        links=tuple(link for _, link in sent),
        state=memory.plant.state,
    )


def _obey(
    memory: AutopilotMemory, inputs: AutopilotInputs, config: AutopilotConfig
) -> tuple[AutopilotMemory, list[_Sent]]:
    """Take what was received, and return the answers, each for the link that it came by."""
    replies: list[_Sent] = []
    for message, link in zip(inputs.messages, inputs.links or repeat(0), strict=False):
        memory, answers = take(at_link(memory, link), message, config)
        replies += [(answer, link) for answer in answers]
    return memory, replies


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
    settings = memory.tuning.settings
    if memory.modes.mode is Mode.OFFBOARD and config.firmware.setpoints.are_lost(memory):
        if settings.setpoints.loss_event is None:
            return disarm(memory)
        memory = change_mode(memory, settings.setpoints.loss_event)
    memory = _mind_sticks(memory)
    return disarm(memory) if should_disarm(memory) else memory


def _mind_sticks(memory: AutopilotMemory) -> AutopilotMemory:
    """Look after sticks that were let go of, and after a pilot who takes over by moving them."""
    sticks, settings, mode = memory.heard.sticks, memory.tuning.settings, memory.modes.mode
    if sticks is None:
        return memory
    held = are_held(sticks, memory.now.boot_ns, settings.sticks)
    memory = mind_lost_sticks(memory, held=held)
    if not held:
        return memory
    moved = sticks.moved_per_s > settings.takeover.moved_per_s and not memory.course.landing.landed
    return change_mode(memory, Event.ASK_POSITION) if moved and mode in settings.takeover.overridden_modes else memory


def _serve(memory: AutopilotMemory, config: AutopilotConfig) -> tuple[AutopilotMemory, tuple[Message, ...]]:
    """Keep watch, go on with the mission, and let the services go on with theirs."""
    memory, told = advance_mission(keep_watch(memory, config), config)
    memory, sent = config.services.advance(memory, config)
    return memory, told + sent


def _warn(
    before: AutopilotMemory, memory: AutopilotMemory, config: AutopilotConfig
) -> tuple[AutopilotMemory, tuple[Message, ...]]:
    """Say what the failsafes have noticed and done."""
    texts, messages = config.firmware.texts, ()
    for text, code in failsafe_texts(before, memory, texts.failsafes):
        telling = tell(memory, text, texts.severity, config, code)
        memory, messages = telling.memory, (*messages, *telling.messages)
    return memory, messages


def _advance(memory: AutopilotMemory, inputs: AutopilotInputs, config: AutopilotConfig) -> AutopilotMemory:
    """Fly to the step's end."""
    duration_s = (inputs.t_ns - memory.now.t_ns) * 1e-9
    course = steer(memory, config, duration_s)
    plant_config = memory.tuning.plant_config
    error = inputs.own_error
    wind_enu_m_s = inputs.wind_enu_m_s + np.array(memory.tuning.settings.simulation.wind_enu_m_s)
    memory, course = over_target(memory, course, duration_s)
    deck = inputs.deck if inputs.deck is None else _on_its_road(inputs.deck, memory.world.deck)
    plant = fly(memory.plant, course.following, deck, wind_enu_m_s, plant_config, duration_s, error)
    east, north, up = wind_enu_m_s.tolist()
    plant = stop_failed(plant, memory.safety.failures)
    now = take_snapshot(plant.state, plant_config.airframe, plant.state.t_ns - memory.boot.start_ns, error)
    return replace(
        memory,
        plant=plant,
        now=now,
        course=course,
        world=World(deck=deck, range_error_m=inputs.range_error_m, wind_enu_m_s=(east, north, up)),
        places=replace(memory.places, chart=near(memory.places.chart, now.position_enu_m)),
    )


def _on_its_road(deck: Deck, before: Deck | None) -> Deck:
    """Return the vehicle with the lowest that its road has led so far."""
    lowest_m = deck.lowest_m if before is None else before.lowest_m
    return replace(deck, lowest_m=min(lowest_m, deck.road_m))


def _after_flight(memory: AutopilotMemory) -> AutopilotMemory:
    """Look after a landing and the end of a take-off."""
    if memory.armed_ns is None:
        return memory
    landing, now = memory.course.landing, memory.now
    if landing.landed or memory.course.climb is not None:
        return memory
    tilt_rad = asked_tilt_rad(memory.plant, memory.course.following)
    landing = detect_landing(landing, now, memory.course.following, memory.tuning.settings, tilt_rad)
    if landing != memory.course.landing:
        memory = replace(memory, course=replace(memory.course, landing=landing))
    if memory.modes.mode is Mode.TAKEOFF and is_takeoff_complete(memory.course.flight, now, memory.tuning.settings):
        memory = with_flight(change_mode(memory, Event.TAKEOFF_COMPLETE), memory.course.flight)
        modes = memory.modes
        return memory if modes.resting is None else replace(memory, modes=replace(modes, resting=modes.mode))
    return memory


def _late_answers(memory: AutopilotMemory) -> tuple[AutopilotMemory, list[Message]]:
    """Return the answers put off until now."""
    if not memory.outbox.later:
        return memory, []
    boot_ns = memory.now.boot_ns
    messages = [later.message for later in memory.outbox.later if later.boot_ns <= boot_ns]
    later = tuple(later for later in memory.outbox.later if later.boot_ns > boot_ns)
    return replace(memory, outbox=replace(memory.outbox, later=later)), messages


def _report_on_each_link(memory: AutopilotMemory, config: AutopilotConfig) -> tuple[AutopilotMemory, list[_Sent]]:
    reports: list[_Sent] = []
    for link in range(len(memory.links.each)):
        memory, own = _reports(at_link(memory, link), config)
        reports += [(report, link) for report in own]
    return memory, reports


def _reports(memory: AutopilotMemory, config: AutopilotConfig) -> tuple[AutopilotMemory, list[Message]]:
    """Return what the link at hand sends of itself: the next parameters of a list under way, and what streams."""
    messages: list[Message] = []
    link = memory.links.here
    streams, due = due_messages(link.streams, memory.now.boot_ns)
    if link.listing is not None:
        parameters, first = config.firmware.parameters.table, link.listing
        end = min(first + _LISTED_A_STEP, len(parameters))
        values, autopilot_id = memory.tuning.values, config.firmware.identity.autopilot_id
        messages += [parameter_message(parameters, index, values, autopilot_id) for index in range(first, end)]
        memory = with_link(memory, replace(link, listing=end if end < len(parameters) else None))
    if due:
        memory = with_link(memory, replace(memory.links.here, streams=streams))
    memory, served = config.services.report(memory, config)
    messages += served
    reports = (build_message(stream, memory, config) for one in due if (stream := stream_of(one, config)))
    return memory, messages + [report for report in reports if report is not None]


def _origin_came(was_ns: int, now_ns: int, config: AutopilotConfig) -> bool:
    """Whether the origin has just become known, when it is sent once unasked."""
    came_ns = 0 if config.instant else round(config.firmware.condition.readiness.position_s * 1e9)
    return was_ns < came_ns <= now_ns or (came_ns == 0 and was_ns == 0)
