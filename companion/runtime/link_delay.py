"""What the exchange of times with the autopilot tells of the link to it."""

from companion.landing.state.step_data import LinkDelay
from link.mavlink.timesync import ClockSync

_DELAY_MAX_S = 0.3  # a longer way is not led for: the model is too uncertain so far ahead


def link_delay(sync: ClockSync, local_ns: int) -> LinkDelay:
    """Return how long messages take, and since when nothing shows that the autopilot hears them.

    Args:
        sync: the exchange.
        local_ns: now. An autopilot that has never answered shows nothing.
    """
    answered_ns, since_ns = sync.answered_ns, sync.answering_since_ns
    return LinkDelay(
        mean_s=min(sync.clock.one_way_s, _DELAY_MAX_S),
        std_s=sync.clock.one_way_std_s,
        unanswered_s=0.0 if answered_ns is None else (local_ns - answered_ns) * 1e-9,
        answering_s=None if since_ns is None else (local_ns - since_ns) * 1e-9,
    )
