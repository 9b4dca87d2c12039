"""How the autopilot starts, and restarts."""

import numpy as np

from link.frames.geodesy import LocalFrame
from link.records import replace
from sim_autopilot.core.links import LinkMemory, Links, Outbox
from sim_autopilot.core.modes import Modes
from sim_autopilot.core.parameters import Values, default_values
from sim_autopilot.core.places import Origin, Places, chart_at
from sim_autopilot.core.streams import default_streams
from sim_autopilot.flight.flight import begin
from sim_autopilot.flight.land_detector import Landing
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory, Boot, Course, Heard, MissionMemory, SafetyMemory, Tuning, World
from sim_autopilot.plant.plant import initial_plant
from sim_autopilot.plant.snapshot import take_snapshot
from sim_autopilot.setpoints.guided import begin_guided


def initial_memory(config: AutopilotConfig, start_ns: int) -> AutopilotMemory:
    """Return an autopilot that starts at `start_ns`, disarmed, its drone at rest.

    Raises:
        ValueError: a parameter of `config` does not exist or is out of range.
    """
    firmware = config.firmware
    parameters, mode = firmware.parameters, firmware.modes.boot
    values = default_values(parameters.table, {parameters.system_id: config.system_id, **config.parameters})
    tuning = tune(config, values)
    place, velocity = np.array(config.position_enu_m), np.array(config.velocity_enu_m_s)
    plant = initial_plant(config.plant, start_ns, place, config.yaw_rad, velocity)
    now = take_snapshot(plant.state, config.plant.airframe, 0)
    frame = LocalFrame(origin=config.datum, projection=firmware.origin.projection)
    streams = firmware.streams.messages.values()
    return AutopilotMemory(
        boot=Boot(start_ns=start_ns),
        plant=plant,
        now=now,
        tuning=tuning,
        modes=Modes(mode=mode, intended=mode),
        armed_ns=None,
        course=Course(
            flight=begin(mode, now, now.position_enu_m, tuning.settings),
            guided=begin_guided(now),
            climb=None,
            landing=Landing(),
            following=None,
        ),
        heard=Heard(),
        places=Places(
            origin=Origin(world=config.datum, frame=frame),
            home_enu_m=now.position_enu_m,
            chart=chart_at(config.datum, now.position_enu_m),
        ),
        world=World(),
        mission=MissionMemory(),
        safety=SafetyMemory(),
        links=Links(each=tuple(LinkMemory(streams=default_streams(streams, rates)) for rates in config.links)),
        outbox=Outbox(),
        station=config.services.begin(),
    )


def tune(config: AutopilotConfig, values: Values) -> Tuning:
    """Return what parameter values amount to: the drone keeps to the envelope that they set."""
    settings = config.firmware.parameters.settings(values)
    plant_config = replace(config.plant, envelope=settings.envelope, gains=settings.gains)
    return Tuning(values=values, settings=settings, plant_config=plant_config)


def restart_in_place(memory: AutopilotMemory, config: AutopilotConfig) -> AutopilotMemory:
    """Return the autopilot rebooted where its drone is; nothing else is remembered."""
    state = memory.plant.state
    now = take_snapshot(state, config.plant.airframe, 0)
    return replace(initial_memory(config, state.t_ns), plant=memory.plant, now=now)


def reboot_if_due(memory: AutopilotMemory, config: AutopilotConfig) -> AutopilotMemory:
    """Return the memory, rebooted if it is time for that.

    Parameters (where they were not reset), the mission, the fence and what the services store are kept; streams,
    origin, home and time begin again.
    """
    again_ns = memory.boot.again_ns
    if again_ns is None or memory.now.boot_ns < again_ns:
        return memory
    mission = MissionMemory(items=memory.mission.items, fence=memory.mission.fence)
    booted = replace(restart_in_place(memory, config), mission=mission, station=config.services.keep(memory.station))
    return booted if memory.boot.forgets else replace(booted, tuning=memory.tuning)
