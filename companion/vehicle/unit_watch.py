"""Whether what a vehicle's inertial unit tells fits together: units, signs and axes."""

from companion.vehicle.gravity_watch import GravityWatch
from companion.vehicle.turn_watch import TurnWatch


class UnitWatch:
    """Watches one unit.

    Attributes:
        gravity: whether its accelerations are believed.
        turns: whether its yaw rates are.
    """

    def __init__(self) -> None:
        self.gravity = GravityWatch()
        self.turns = TurnWatch()

    def doubts(self) -> dict[str, str]:
        """Return what is not believed, and why."""
        told = {"acceleration": self.gravity.doubt, "yaw rate": self.turns.doubt}
        return {what: why for what, why in told.items() if why is not None}
