"""A companion's status in which nothing but time and phase is known, for tests that tell the rest."""

from companion.situation.phases import Phase
from link.messages import LandingStatus


def status_of(stamp_ns: int, phase: Phase) -> LandingStatus:
    """Return the status of an armed drone; `link.records.replace` tells more."""
    return LandingStatus(
        stamp_ns=stamp_ns,
        phase=phase.value,
        reason="",
        relative_position_enu_m=None,
        relative_velocity_enu_m_s=None,
        height_above_pad_m=None,
        time_to_contact_s=None,
        armed=True,
        fix_age_s=None,
    )
