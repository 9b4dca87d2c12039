"""The command `ros2 topics`: what the ROS 2 graph on Zenoh shows."""

import json
import os
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from link.program.cli import JsonOption, make_app
from link.zenoh.command_line import ZenohArguments

if TYPE_CHECKING:
    from link.ros2.names import Token


def register(app: typer.Typer) -> None:
    """Add the command to `app`."""
    group = make_app("Look at a ROS 2 graph over rmw_zenoh, without ROS.")
    group.callback()(_group)  # by its own, a single command would take the group's name
    group.command("topics")(topics_command)
    app.add_typer(group, name="ros2")


def _group() -> None:
    """Look at a ROS 2 graph over rmw_zenoh, without ROS."""


def topics_command(
    *,
    domain: Annotated[
        int | None, typer.Option("--domain", min=0, max=232, help="[default: ROS_DOMAIN_ID, else 0].")
    ] = None,
    as_json: JsonOption = False,
    endpoints: ZenohArguments,
) -> None:
    """List topics, services and actions with their types and nodes, as the liveliness tokens of the graph tell them."""
    from link.errors import UserError
    from link.ros2.ros_node import read_graph

    text = os.environ.get("ROS_DOMAIN_ID") or "0"
    if domain is None and not text.isdigit():
        raise UserError(f"ROS_DOMAIN_ID is {text!r}: give --domain, a number from 0 to 232")
    options = endpoints.options()
    rows = topic_rows(read_graph(options, int(text) if domain is None else domain))
    if not rows:
        raise UserError(
            f"nobody tells of a topic in domain {text if domain is None else domain}: start a ROS 2 node, or check "
            "--domain, and -e with the router's address"
        )
    if as_json:
        sys.stdout.write(json.dumps({"topics": rows}, indent=2) + "\n")
        return
    for row in rows:
        sys.stdout.write(f"{row['topic']}  {row['type']}\n")
        for role in _ROLES:
            if row[role]:
                sys.stdout.write(f"    {role.replace('_', ' ')}: {', '.join(row[role])}\n")


_ROLES = ("publishers", "subscriptions", "services", "clients", "actions", "action_clients")
_ACTION = "/_action/feedback"
_ACTION_TYPE = "_FeedbackMessage"
_ACTION_ROLES = {"publishers": "actions", "subscriptions": "action_clients"}


def topic_rows(tokens: "list[Token]") -> list[dict[str, Any]]:
    """Return a row for each topic, service and action with the full names of its nodes, without what ROS hides."""
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for token in tokens:
        if token.endpoint is None:
            continue
        name, type_name, role = token.endpoint.name, token.endpoint.type_name, f"{token.kind.name.lower()}s"
        if name.endswith(_ACTION) and role in _ACTION_ROLES:
            name, type_name, role = (
                name.removesuffix(_ACTION),
                type_name.removesuffix(_ACTION_TYPE),
                _ACTION_ROLES[role],
            )
        if "/_" in name:
            continue
        row = found.setdefault((name, type_name), {"topic": name, "type": type_name} | {one: [] for one in _ROLES})
        node = f"{token.namespace.rstrip('/')}/{token.node}"
        if node not in row[role]:
            row[role].append(node)
    for row in found.values():
        for role in _ROLES:
            row[role].sort()
    return [found[key] for key in sorted(found)]
