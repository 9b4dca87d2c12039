"""A companion from its configuration."""

from companion.config import CompanionConfig
from companion.estimation.factory import make_estimator
from companion.node import CompanionNode
from companion.planning.kinds import make_guidance
from companion.step_data import System
from link.keys import Keys
from link.mavlink.session import MavlinkSession
from link.mavlink.session_config import SessionConfig


def build_node(
    config: CompanionConfig,
    keys: Keys,
    *,
    system_id: int = 1,
    dry_run: bool = False,
    records_input: bool = False,
) -> CompanionNode:
    """Return a companion that has seen nothing yet.

    Args:
        config: all its numbers.
        keys: of the Zenoh contract.
        system_id: MAVLink's, the vehicle's own.
        dry_run: send neither setpoints nor commands.
        records_input: keep received frames for a recording.
    """
    system = System(
        config=config,
        estimator=make_estimator(config.estimator),
        guidance=make_guidance(config.guidance.kind, config.guidance),
    )
    session = MavlinkSession(system_id, config=SessionConfig(records_input=records_input))
    return CompanionNode(system, keys, session, dry_run=dry_run)
