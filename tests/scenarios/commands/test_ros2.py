"""What `scenarios ros2 topics` lists, as `ros2 topic`, `service` and `action list` would."""

from link.ros2.land_types import endpoints
from link.ros2.names import Endpoint, EntityKind, Token
from link.ros2.routes import topic, trigger
from scenarios.commands.ros2 import topic_rows

PARTS = {
    "send": EntityKind.SERVICE,
    "get": EntityKind.SERVICE,
    "cancel": EntityKind.SERVICE,
    "feedback": EntityKind.PUBLISHER,
    "status": EntityKind.PUBLISHER,
}


def _token(kind: EntityKind, endpoint: Endpoint | None, node: str = "companion") -> Token:
    return Token(
        domain=0, session_id="a", node_id=0, entity_id=1, kind=kind, namespace="/drone", node=node, endpoint=endpoint
    )


def test_actions_are_listed_as_one_and_their_parts_are_hidden() -> None:
    there = endpoints("/drone/landing/land")
    tokens = [
        _token(EntityKind.NODE, None),
        *(_token(kind, there[part]) for part, kind in PARTS.items()),
        _token(EntityKind.SUBSCRIPTION, there["feedback"], "mission"),
        _token(EntityKind.PUBLISHER, topic("/drone/landing/status", "std_msgs/msg/String")),
        _token(EntityKind.SERVICE, trigger("/drone/landing/start")),
    ]
    rows = {row["topic"]: {key: value for key, value in row.items() if value} for row in topic_rows(tokens)}
    assert rows == {
        "/drone/landing/land": {
            "topic": "/drone/landing/land",
            "type": "decklander_msgs/action/Land",
            "actions": ["/drone/companion"],
            "action_clients": ["/drone/mission"],
        },
        "/drone/landing/start": {
            "topic": "/drone/landing/start",
            "type": "std_srvs/srv/Trigger",
            "services": ["/drone/companion"],
        },
        "/drone/landing/status": {
            "topic": "/drone/landing/status",
            "type": "std_msgs/msg/String",
            "publishers": ["/drone/companion"],
        },
    }
