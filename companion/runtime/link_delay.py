"""What the exchange of times with the autopilot tells of the link to it."""

from companion.landing.state.step_data import LinkDelay
from link.mavlink.clock_map import ClockMap

_DELAY_MAX_S = 0.3  # a longer way is not led for: the model is too uncertain so far ahead


def link_delay(clock: ClockMap, local_ns: int) -> LinkDelay:
    """Return how long messages take, and since when nothing shows that the autopilot hears them.

    Args:
        clock: what the exchange has told.
        local_ns: now. An autopilot that has never answered shows nothing.
    """
    answered_ns = clock.answered_ns
    return LinkDelay(
        mean_s=min(clock.one_way_s, _DELAY_MAX_S),
        std_s=clock.one_way_std_s,
        unanswered_s=0.0 if answered_ns is None else (local_ns - answered_ns) * 1e-9,
    )
