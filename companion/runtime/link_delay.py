"""What tells of the link to the autopilot: the exchange of times with it, and which setpoints it flies to."""

from companion.landing.state.step_data import LinkDelay
from link.mavlink.answers import Answers
from link.mavlink.timesync import ClockSync

_DELAY_MAX_S = 0.3  # a longer way is not led for: the model is too uncertain so far ahead


def link_delay(sync: ClockSync, setpoints: Answers, local_ns: int) -> LinkDelay:
    """Return how long messages take, and since when nothing shows that the autopilot hears setpoints.

    Args:
        sync: the exchange. Its answers count for those to setpoints of an autopilot that never tells what it flies to.
        setpoints: how they show in what the autopilot says that it flies to.
        local_ns: now. An autopilot that has never answered shows nothing.
    """
    answers = sync.answers if setpoints.sent_ns is None else setpoints
    return LinkDelay(
        mean_s=min(sync.clock.one_way_s, _DELAY_MAX_S),
        std_s=sync.clock.one_way_std_s,
        unanswered_s=0.0 if answers.sent_ns is None else (local_ns - answers.sent_ns) * 1e-9,
        answering_s=None if answers.since_ns is None else (local_ns - answers.since_ns) * 1e-9,
    )
