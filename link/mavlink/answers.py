"""Since when a peer shows without a gap that it hears what is sent to it."""

from msgspec import Struct

ANSWER_GAP_S = 0.2
"""Between things answered, from which on a peer may not hear. Where 50 a second are sent and answered, a link that
loses a fifth of all frames on each way has it once in 27,000 times."""


class Answers(Struct, frozen=True, kw_only=True):
    """What is known of it; times are local.

    Attributes:
        sent_ns: when the newest thing that was answered had been sent, None before the first.
        since_ns: since when answers have come without a gap as above, None before the first.
    """

    sent_ns: int | None = None
    since_ns: int | None = None


def with_answer(answers: Answers, sent_ns: int, t_ns: int) -> Answers:
    """Return what is known after an answer, at `t_ns`, to what was sent at `sent_ns`."""
    newest_ns, since_ns = answers.sent_ns, answers.since_ns
    if newest_ns is None or sent_ns - newest_ns > ANSWER_GAP_S * 1e9:
        since_ns = t_ns
    return Answers(sent_ns=max(sent_ns, newest_ns or sent_ns), since_ns=since_ns)
