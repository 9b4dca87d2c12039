"""What the exchange of times with the autopilot tells of the link to it."""

from companion.config.companion import CompanionConfig
from companion.landing.state.step_data import LinkDelay
from companion.situation.phases import Phase
from link.mavlink.timesync import ClockSync
from link.messages import LandingStatus

_DELAY_MAX_S = 0.3  # a longer way is not led for: the model is too uncertain so far ahead


def link_delay(sync: ClockSync, local_ns: int) -> LinkDelay:
    """Return how long messages take, and since when nothing shows that the autopilot hears them.

    Args:
        sync: the exchange.
        local_ns: now. An autopilot that has never answered shows nothing.
    """
    answered_ns = sync.answered_ns
    return LinkDelay(
        mean_s=min(sync.clock.one_way_s, _DELAY_MAX_S),
        std_s=sync.clock.one_way_std_s,
        unanswered_s=0.0 if answered_ns is None else (local_ns - answered_ns) * 1e-9,
    )


def may_touch(status: LandingStatus, config: CompanionConfig) -> bool:
    """Return whether a contact may be believed soon, so that it has to be known whether the autopilot hears."""
    height_m = status.height_above_pad_m
    is_low = height_m is not None and height_m < max(config.descent.commit_height_m, config.touchdown.height_max_m)
    return is_low and status.phase == Phase.DESCEND.value
