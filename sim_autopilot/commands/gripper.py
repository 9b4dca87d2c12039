"""PX4's gripper: it opens and closes for as long as its parameter says, and knows by that alone that it has.

Source: PX4's payload deliverer, https://docs.px4.io/main/en/peripherals/gripper.html, and what its simulation answers.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Gripper:
    """What it was last told: to release (0) or to grab (1), as it does at boot; and when it is done, since boot."""

    action: int = 1
    done_ns: int = 0

    def moves(self, boot_ns: int) -> bool:
        """Return whether it is still at it."""
        return boot_ns < self.done_ns


AT_REST = Gripper()
