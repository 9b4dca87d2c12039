"""The reference of what is on the wires: Zenoh keys with their types, and MAVLink messages, from their code."""

import ast
import inspect
import json
import re
from collections.abc import Iterator, Mapping
from importlib import resources
from importlib.resources.abc import Traversable

from msgspec import StructMeta, structs

from link import messages
from link.mavlink.dialect import mavlink
from link.payloads import json_messages
from link.payloads.cdr import ROS_TYPES
from link.payloads.decklander_msgs import DEFINITIONS, PACKAGE
from link.zenoh.keys import Keys
from scenarios.manual.markdown import block, code, page, table
from scenarios.manual.types_in_words import type_in_words, unit_of
from sim_autopilot.commands.incoming import HANDLED
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.firmware.px4.px4 import PX4
from sim_autopilot.ground_station.ardupilot import ARDUPILOT_STATION
from sim_autopilot.ground_station.px4.station import PX4_STATION
from sim_autopilot.ground_station.station import HANDLED as SERVED

KEYS = Keys(namespace="{ns}", vehicle="{vehicle}", drone="{drone}")
MESSAGE_NAMES: Mapping[int, str] = {number: one.msgname for number, one in mavlink.mavlink_map.items()}
ZENOH = """Payloads with a ROS 2 type are that message in CDR, with the Zenoh encoding `application/cdr;TYPE`; the
others are JSON. `{ns}`, `{vehicle}` and `{drone}` are what `--ns`, `--vehicle` and `--drone` say: `decklander`,
`vehicle` and `drone` unless told otherwise. [Keys and messages](../wire.md) says which are optional and what
a -1 in a covariance means."""
MAVLINK = """What the companion takes from an autopilot and what it sends there. "Asks for" means that it sets the
message's rate. A message that is not listed is not read."""
SIMULATED = """What `sim-autopilot` sends unasked, per second, and what it obeys or answers; all of the first can
be asked for at other rates. [The simulated autopilot](../sim_autopilot.md) says more, commands and parameters
included."""


def wire_page() -> str:
    """Return the page of the wire contract."""
    sections = [
        "## Zenoh",
        ZENOH,
        table(("key", "ROS 2 type", "what"), _keys()),
        "### What the messages hold",
        "In SI units, radians, east-north-up (W) and forward-left-up (B, V): this is what the programs make of them.",
        *(_message(name) for name in _described_names()),
        "### Schema of `landing/status`",
        block(json.dumps(json_messages.LANDING_STATUS_SCHEMA, indent=2)),
        "### Messages of our own",
        f"Types `{PACKAGE}/...`, in [recordings](../recording.md) and for the [live view](../view.md).",
        *(f"**{name}**\n\n{block(definition)}" for name, definition in DEFINITIONS.items()),
        "## MAVLink of the companion",
        MAVLINK,
        table(("message", "id", "companion"), _companion()),
        "## MAVLink of the simulated autopilot",
        SIMULATED,
        table(("message", "id", "PX4 sends, Hz", "ArduCopter sends, Hz", "read"), _simulated()),
    ]
    return page("Wire contract", *sections)


def _keys() -> Iterator[tuple[str, str, str]]:
    for name, member in inspect.getmembers(Keys, lambda member: isinstance(member, property)):
        text = inspect.getdoc(member) or ""
        classes = [one for one in ROS_TYPES if re.search(rf"\b{one.__name__}\b", text)]
        yield code(getattr(KEYS, name)), code(ROS_TYPES[classes[0]]) if classes else "", text


def _described_names() -> list[str]:
    """Return the names of the messages that the keys speak of, as they come."""
    return [name for name, one in vars(messages).items() if isinstance(one, StructMeta)]


def _message(name: str) -> str:
    owner = getattr(messages, name)
    annotations = {name: one for base in reversed(owner.__mro__) for name, one in inspect.get_annotations(base).items()}
    rows = [
        (
            code(one.name),
            type_in_words(annotations[one.name]),
            unit_of(one.name.replace("_enu", "").replace("_flu", "")),
        )
        for one in structs.fields(owner)
    ]
    return f"**{name}**: {inspect.getdoc(owner)}\n\n{table(('field', 'type', 'unit'), rows)}"


def _companion() -> Iterator[tuple[str, str, str]]:
    """Yield the messages that the companion's own sources and the session that it uses name."""
    trees = [*_trees("companion"), *_trees("link")]
    uses: dict[str, set[str]] = {}
    for tree in trees:
        for name, use in _uses(tree):
            uses.setdefault(name, set()).add(use)
    for number, name in sorted(MESSAGE_NAMES.items()):
        if name in uses:
            yield name, f"{number}", ", ".join(sorted(uses[name]))


def _uses(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Yield a message's name and what a source does with it, for every place where it is named."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and (
            made := re.fullmatch(r"mavlink\.MAVLink_(\w+)_message", ast.unparse(node.func))
        ):
            yield made[1].upper(), "sends"
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(".get"):
            yield from ((name, "reads") for name in _names_of(node.args))
        elif isinstance(node, ast.Compare):
            yield from ((name, "reads") for name in _names_of(node.comparators))
        elif isinstance(node, ast.MatchValue):
            yield from ((name, "reads") for name in _names_of([node.value]))
        elif isinstance(node, ast.Dict):
            yield from ((name, "asks for") for name in _names_of([key for key in node.keys if key is not None]))


def _names_of(nodes: list[ast.expr]) -> Iterator[str]:
    for node in nodes:
        text = f"{node.value!s}" if isinstance(node, ast.Constant) else ast.unparse(node)
        name = text.removeprefix("mavlink.MAVLINK_MSG_ID_")
        if name in MESSAGE_NAMES.values():
            yield name


def _trees(package: str) -> Iterator[ast.Module]:
    for file in _sources(resources.files(package)):
        yield ast.parse(file.read_text(encoding="utf-8"))


def _sources(folder: Traversable) -> Iterator[Traversable]:
    for one in folder.iterdir():
        if one.is_dir():
            yield from _sources(one)
        elif one.name.endswith(".py"):
            yield one


def _simulated() -> Iterator[tuple[str, ...]]:
    streams = (
        {**PX4.streams.messages, **PX4_STATION.streams},
        {**ARDUPILOT.streams.messages, **ARDUPILOT_STATION.streams},
    )
    read = HANDLED | SERVED | {*PX4_STATION.messages, *ARDUPILOT_STATION.messages}
    for number in sorted({*streams[0], *streams[1], *read}):
        rates = [f"{one[number].rate_hz:g}" if number in one else "" for one in streams]
        yield MESSAGE_NAMES[number], f"{number}", *rates, "yes" if number in read else ""
