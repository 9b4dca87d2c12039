"""ArduCopter's reboot by command: refused while armed, and then a boot that keeps what a real one has stored."""

from link.records import replace
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory, initial_memory
from sim_autopilot.requests import ACCEPTED, UNSUPPORTED, Answer, Request
from sim_autopilot.services import Services
from sim_autopilot.snapshot import take_snapshot

_NOTHING, _REBOOT, _TO_BOOTLOADER = 0, 1, 3
_FORCED = 20190226
_AFTER_NS = 300_000_000
"""From the acknowledgement until it stops."""


def reboot(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Boot again. PX4's simulation cannot, and denies it; to shut down is refused by both.

    What stands in for an autopilot ends when its process is told to.
    """
    wanted, refused = request.number(1), config.firmware.results.reboot_refused
    if wanted == _NOTHING:
        return Answer(memory=memory, result=ACCEPTED)
    if not config.firmware.guided:
        return Answer(memory=memory, result=refused)
    if memory.armed_ns is not None and request.number(6) != _FORCED:
        return Answer(memory=memory, result=refused)
    if wanted not in {_REBOOT, _TO_BOOTLOADER}:
        return Answer(memory=memory, result=UNSUPPORTED)
    services = replace(memory.services, reboot_ns=memory.now.boot_ns + _AFTER_NS)
    return Answer(memory=replace(memory, services=services), result=ACCEPTED)


def rebooted(memory: AutopilotMemory, config: AutopilotConfig) -> AutopilotMemory:
    """Return the memory, booted anew if it is time for that.

    Parameters (where they were not reset), plans, the fence, files and logs are stored; streams, origin, home and time
    begin again.
    """
    reboot_ns = memory.services.reboot_ns
    if reboot_ns is None or memory.now.boot_ns < reboot_ns:
        return memory
    state, kept = memory.plant.state, memory.services
    library = replace(kept.library, transfer=None)
    ftp = replace(kept.ftp, opened=None, burst=None, last=None, asked_ns=0)
    logs = replace(kept.logs, sending=None, next_ns=0)
    services = Services(library=library, fence=kept.fence, ftp=ftp, logs=logs)
    now = take_snapshot(state, config.plant.airframe, 0)
    booted = replace(initial_memory(config, state.t_ns), plant=memory.plant, now=now, services=services)
    if kept.forgets:
        return booted
    return replace(booted, values=memory.values, settings=memory.settings, plant_config=memory.plant_config)
