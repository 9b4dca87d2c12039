"""Asks the vehicle for its pad, gives the node what it answers, and tells it of an answer that is another one."""

from companion.runtime.node import CompanionNode
from companion.situation.phases import FLYING_PHASES
from link.zenoh.pad_question import Asks, PadQuestion


class PadWatch:
    """Asks until the vehicle has answered, and again when it has come back: it may be another one.

    Args:
        zenoh: to ask by.
        key: of the pad.
    """

    def __init__(self, zenoh: Asks, key: str) -> None:
        self._question = PadQuestion(zenoh, key)
        self._was_alive = False

    def poll(self, node: CompanionNode, now_s: float, *, alive: bool, fix_seen: bool) -> str | None:
        """Take what has come; return why an answer is refused, once for each reason.

        Args:
            node: that is to know the pad.
            now_s: of a monotonic clock.
            alive: the vehicle's liveliness token is there.
            fix_seen: a fix of it has come.
        """
        question = self._question
        if alive and not self._was_alive:
            question.ask_anew()
        self._was_alive = alive
        why, bad = question.refused_why, question.bad_answers
        pad = question.poll(now_s, asks=alive or fix_seen, may_change=node.phase not in FLYING_PHASES)
        for _ in range(question.bad_answers - bad):
            node.vehicle.refuse("pad", "refused", question.refused_why or "")
        if pad is not None:
            node.receive_pad(pad)
        elif question.is_contradicted:
            node.doubt_pad()
        return question.refused_why if question.refused_why != why else None
