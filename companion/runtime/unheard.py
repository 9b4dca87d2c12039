"""What to say of an autopilot that was not heard: what came instead, and what to change."""

from link.errors import UserError
from link.mavlink.session import MavlinkSession


def check_autopilot(session: MavlinkSession, device: str, timeout_s: float) -> None:
    """See to it that an autopilot was heard.

    Args:
        session: to it.
        device: that it was listened to on, for messages.
        timeout_s: for how long.

    Raises:
        UserError: none was.
    """
    if session.autopilot is None:
        raise UserError(f"no heartbeat of an autopilot within {timeout_s:g} s on {device}: {_seen(session)}")


def _seen(session: MavlinkSession) -> str:
    """Return what came instead, with what to change."""
    causes, codec = [], session.statistics.codec
    if session.other_system_ids:
        others = ", ".join(map(str, sorted(session.other_system_ids)))
        causes.append(f"autopilots of system {others} were heard, see --system-id")
    if codec.refused_messages:
        causes.append(
            f"{codec.refused_messages} messages were refused: not signed with this --signing-key, or the autopilot's "
            "time is more than a minute behind; give both the same key and the right time"
        )
    if causes:
        return "; ".join(causes)
    came = f"{codec.bytes_received} bytes received, {codec.messages_received} messages, none of them its heartbeat"
    return f"{came if codec.bytes_received else 'nothing was received'}; check --mavlink and the autopilot's port"
