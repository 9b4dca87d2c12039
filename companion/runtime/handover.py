"""The end of the companion in flight: the drone is handed over to its autopilot, and the pilot is told so."""

import time
from collections.abc import Callable

from companion.runtime.node import CompanionNode
from link.recording.log import Log

_LEAVE_MAX_S = 1.5  # a mode may be confirmed by the next heartbeat only


def hand_over(node: CompanionNode, turn: Callable[[], None], log: Log) -> None:
    """Let the autopilot hover by itself; it may take setpoints that stop for a fault, or fly on.

    Args:
        node: the companion.
        turn: of its loop, which sends and receives.
        log: says who has the drone.
    """
    driver = node.autopilot.driver
    if driver is None or not node.flies:
        return
    log.warning("stopped in flight", phase=node.phase.value, asks_for=driver.hover_mode)
    node.leave()
    if not _is_released(node, turn):
        log.warning("handed over without an answer: the autopilot acts by its parameter", name=driver.timeout_parameter)
    elif node.autopilot.state.view.armed:
        log.warning("handed over: the autopilot flies the drone", mode=driver.hover_mode)
    else:
        log.info("the motors are off")


def _is_released(node: CompanionNode, turn: Callable[[], None]) -> bool:
    until_s = time.monotonic() + _LEAVE_MAX_S
    while node.flies and time.monotonic() < until_s:
        turn()
    return not node.flies
