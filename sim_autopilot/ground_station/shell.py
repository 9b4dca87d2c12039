"""PX4's shell over SERIAL_CONTROL: what is typed is echoed, a whole line is obeyed, and the prompt follows.

It knows what clients ask it for: help, its version, parameters, the commander's state. Words: PX4's own simulation.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.commands.incoming_parameters import with_value
from sim_autopilot.core.parameters import find_index, is_allowed
from sim_autopilot.ground_station.memory import station_of, with_station
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory

_PIECE, _LINE_MAX = 70, 1024
_PROMPT = "pxh> "
_SHELL = int(mavlink.SERIAL_CONTROL_DEV_SHELL)
_REPLY = int(mavlink.SERIAL_CONTROL_FLAG_REPLY)

Result = tuple[AutopilotMemory, tuple[Message, ...]]
Spoken = tuple[AutopilotMemory, str]


def take_typed(memory: AutopilotMemory, message: Message, config: AutopilotConfig) -> Result:
    """Take a SERIAL_CONTROL, and return what the shell prints; other devices are silent."""
    if message.device != _SHELL or message.flags & _REPLY:
        return memory, ()
    typed = bytes(message.data[: min(message.count, _PIECE)]).decode("ascii", "replace")
    *lines, rest = (station_of(memory).typed + typed).split("\n")
    printed = typed
    for line in lines:
        memory, said = _obey(memory, line, config)
        printed += said + _PROMPT
    memory = with_station(memory, replace(station_of(memory), typed=rest[-_LINE_MAX:]))
    return memory, _pieces(printed)


def _pieces(text: str) -> tuple[Message, ...]:
    data = text.encode()
    parts = (data[begin : begin + _PIECE] for begin in range(0, len(data), _PIECE))
    return tuple(
        mavlink.MAVLink_serial_control_message(_SHELL, _REPLY, 0, 0, len(part), list(part.ljust(_PIECE, b"\0")))
        for part in parts
    )


def _obey(memory: AutopilotMemory, line: str, config: AutopilotConfig) -> Spoken:
    words = line.split()
    if not words:
        return memory, ""
    command = _COMMANDS.get(words[0])
    if command is None:
        return memory, f"Invalid command: {words[0]}\ntype 'help' for a list of commands\n"
    return command(memory, words[1:], config)


def _help(memory: AutopilotMemory, _words: list[str], _config: AutopilotConfig) -> Spoken:
    return memory, "Builtin Commands:\n" + "".join(f"  {name}\n" for name in sorted(_COMMANDS))


def _version(memory: AutopilotMemory, words: list[str], config: AutopilotConfig) -> Spoken:
    if words not in (["all"], ["git"], ["hw"], ["hwcmp"]):
        return memory, "usage: ver {hw|git|all}\n"
    version, commit = config.firmware.identity.version, config.firmware.identity.custom_version
    board = "HW arch: PX4_SITL\n"
    build = (
        f"PX4 git-hash: {commit[::-1].hex()}\n"
        f"PX4 version: {version >> 24}.{version >> 16 & 255}.{version >> 8 & 255} {version & 255} ({version})\n"
    )
    parts = {"hw": (board,), "hwcmp": (board,), "git": (build,), "all": (board, build, "OS: Linux\n")}
    return memory, "".join(parts[words[0]])


def _parameter(memory: AutopilotMemory, words: list[str], config: AutopilotConfig) -> Spoken:
    match words:
        case ["show"]:
            return memory, _list_parameters(
                memory, [parameter.name for parameter in config.firmware.parameters.table], config
            )
        case ["show", pattern]:
            begins = pattern.removesuffix("*")
            names = [parameter.name for parameter in config.firmware.parameters.table]
            chosen = [name for name in names if name == pattern or (begins != pattern and name.startswith(begins))]
            return memory, _list_parameters(memory, chosen, config)
        case ["set", name, value]:
            return _set(memory, name, value, config)
        case _:
            return memory, "usage: param {show [name]|set name value}\n"


def _list_parameters(memory: AutopilotMemory, names: list[str], config: AutopilotConfig) -> str:
    parameters = config.firmware.parameters.table
    said = "Symbols: x = used, + = saved, * = unsaved\n"
    for name in names:
        index = find_index(parameters, name) or 0
        value = memory.tuning.values[name]
        shown = f"{value:.0f}" if parameters[index].is_integer else f"{value:.4f}"
        said += f"x   {name} [{index},{index}] : {shown}\n"
    return f"{said}\n {len(parameters)}/{len(parameters)} parameters used.\n"


def _set(memory: AutopilotMemory, name: str, text: str, config: AutopilotConfig) -> Spoken:
    index = find_index(config.firmware.parameters.table, name)
    if index is None:
        return memory, f"ERROR [param] Parameter {name} not found.\n"
    try:
        value = float(text)
    except ValueError:
        return memory, f"ERROR [param] {text} is no value for {name}\n"
    if not is_allowed(config.firmware.parameters.table[index], value):
        return memory, f"ERROR [param] {text} is no value for {name}\n"
    before = memory.tuning.values[name]
    return with_value(memory, name, value, config), f"  {name}: curr: {before:.4f} -> new: {value:.4f}\n"


def _commander(memory: AutopilotMemory, words: list[str], config: AutopilotConfig) -> Spoken:
    if words != ["status"]:
        return memory, "usage: commander status\n"
    modes = config.firmware.modes.codes
    state = "Disarmed" if memory.armed_ns is None else "Armed"
    flown, asked = (modes[mode].name.capitalize() for mode in (memory.modes.mode, memory.modes.intended))
    failsafe = "yes" if memory.modes.failsafe else "no"
    return memory, (
        f"INFO  [commander] {state}\n"
        f"INFO  [commander] navigation mode: {flown}\n"
        f"INFO  [commander] user intended navigation mode: {asked}\n"
        f"INFO  [commander] in failsafe: {failsafe}\n"
    )


_COMMANDS: Mapping[str, Callable[[AutopilotMemory, list[str], AutopilotConfig], Spoken]] = MappingProxyType(
    {"help": _help, "ver": _version, "param": _parameter, "commander": _commander}
)
