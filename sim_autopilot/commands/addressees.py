"""Whom a message is meant for."""

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.interfaces import AutopilotConfig


def is_for_us(message: Message, config: AutopilotConfig) -> bool:
    """Return whether a command concerns this autopilot; others are not answered at all."""
    if message.target_system == 0 and config.firmware.commands.answers_other_components:
        return True
    if message.target_system != config.system_id:
        return False
    ours = (mavlink.MAV_COMP_ID_AUTOPILOT1, mavlink.MAV_COMP_ID_ALL)
    return config.firmware.commands.answers_other_components or message.target_component in ours


def is_ours(message: Message, config: AutopilotConfig) -> bool:
    """Return whether a message that is no command is meant for this autopilot; 0 is everybody."""
    components = (mavlink.MAV_COMP_ID_AUTOPILOT1, mavlink.MAV_COMP_ID_ALL)
    concerns = config.firmware.commands.answers_other_components or message.target_component in components
    return message.target_system in (config.system_id, 0) and concerns
