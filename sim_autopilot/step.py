"""One step of the simulated autopilot: messages in, 10 ms of flight, messages out.

Order of a step: obey what was received, look after modes and motors, fly to `t_ns`, report the state then.
"""

from dataclasses import replace

from link.mavlink.dialect import Message
from sim_autopilot.arming import disarm, should_disarm
from sim_autopilot.chart import near
from sim_autopilot.flight import is_takeoff_complete
from sim_autopilot.incoming import take
from sim_autopilot.land_detector import detect_landing
from sim_autopilot.memory import AutopilotConfig, AutopilotInputs, AutopilotMemory, AutopilotOutputs
from sim_autopilot.mode_change import change_mode
from sim_autopilot.modes import Event, Mode
from sim_autopilot.parameters import parameter_message
from sim_autopilot.plant import fly
from sim_autopilot.setpoints import are_fresh
from sim_autopilot.snapshot import take_snapshot
from sim_autopilot.steering import steer
from sim_autopilot.streams import due_messages
from sim_autopilot.telemetry import build_message
from sim_autopilot.telemetry_motion import gps_global_origin


def autopilot_step(
    memory: AutopilotMemory, inputs: AutopilotInputs, config: AutopilotConfig
) -> tuple[AutopilotMemory, AutopilotOutputs]:
    """Return the autopilot at `inputs.t_ns`, what it sends then, and the true state.

    Args:
        memory: after the last step.
        inputs: received since then; its time is one or more control periods later.
        config: what does not change.
    """
    messages: list[Message] = []
    for message in inputs.messages:
        memory, answers = take(memory, message, config)
        messages += answers
    was_ns = memory.now.boot_ns
    memory, due = _advance(_supervise(memory), inputs, config)
    memory = _after_flight(memory)
    if _origin_came(was_ns, memory.now.boot_ns, config):
        messages.append(gps_global_origin(memory, config))
    memory, late = _late_answers(memory, config)
    messages += late
    reports = (build_message(config.firmware.streams[message_id], memory, config) for message_id in due)
    messages += [report for report in reports if report is not None]
    return memory, AutopilotOutputs(messages=tuple(messages), state=memory.plant.state)


def _supervise(memory: AutopilotMemory) -> AutopilotMemory:
    """Look after lost setpoints and motors that run for nothing."""
    if memory.armed_ns is None:
        return memory
    settings = memory.settings
    lost = not are_fresh(memory.setpoints, memory.now.boot_ns, settings.setpoint_loss_s)
    if lost and memory.modes.mode is Mode.OFFBOARD:
        if settings.setpoint_loss_event is None:
            return disarm(memory)
        memory = change_mode(memory, settings.setpoint_loss_event)
    return disarm(memory) if should_disarm(memory) else memory


def _advance(
    memory: AutopilotMemory, inputs: AutopilotInputs, config: AutopilotConfig
) -> tuple[AutopilotMemory, list[int]]:
    """Fly to the step's end; also return which streams are due there."""
    duration_s = (inputs.t_ns - memory.now.t_ns) * 1e-9
    steering = steer(memory, config, duration_s)
    plant_config = memory.plant_config
    plant = fly(memory.plant, steering.following, inputs.deck, inputs.wind_enu_m_s, plant_config, duration_s)
    now = take_snapshot(plant.state, plant_config.airframe, plant.state.t_ns - memory.start_ns)
    streams, due = due_messages(memory.streams, now.boot_ns)
    memory = replace(
        memory,
        plant=plant,
        now=now,
        flight=steering.flight,
        climb=steering.climb,
        landing=steering.landing,
        following=steering.following,
        deck=inputs.deck,
        streams=streams,
        chart=near(memory.chart, now.position_enu_m),
    )
    return memory, due


def _after_flight(memory: AutopilotMemory) -> AutopilotMemory:
    """Look after a landing and the end of a take-off."""
    if memory.armed_ns is None:
        return memory
    landing, now = memory.landing, memory.now
    if landing.landed or memory.climb is not None:
        return memory
    landing = detect_landing(landing, now, memory.following, memory.settings)
    if landing != memory.landing:
        memory = replace(memory, landing=landing)
    if memory.modes.mode is Mode.TAKEOFF and is_takeoff_complete(memory.flight, now):
        return change_mode(memory, Event.TAKEOFF_COMPLETE)
    return memory


def _late_answers(memory: AutopilotMemory, config: AutopilotConfig) -> tuple[AutopilotMemory, list[Message]]:
    """Return the answers put off until now, and the next parameter of a list under way."""
    messages: list[Message] = []
    if memory.later:
        boot_ns = memory.now.boot_ns
        messages += [later.message for later in memory.later if later.boot_ns <= boot_ns]
        memory = replace(memory, later=tuple(later for later in memory.later if later.boot_ns > boot_ns))
    if memory.listing is not None:
        parameters, index = config.firmware.parameters, memory.listing
        messages.append(parameter_message(parameters, index, memory.values, config.firmware.autopilot_id))
        memory = replace(memory, listing=index + 1 if index + 1 < len(parameters) else None)
    return memory, messages


def _origin_came(was_ns: int, now_ns: int, config: AutopilotConfig) -> bool:
    """Whether the origin has just become known, when it is sent once unasked."""
    came_ns = 0 if config.instant else round(config.firmware.readiness.position_s * 1e9)
    return was_ns < came_ns <= now_ns or (came_ns == 0 and was_ns == 0)
