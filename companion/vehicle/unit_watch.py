"""Whether what a vehicle's inertial unit tells fits together: units, signs and axes."""

from companion.vehicle.gravity_watch import GravityWatch
from companion.vehicle.push_watch import PushWatch
from companion.vehicle.turn_watch import TurnWatch


class UnitWatch:
    """Watches one unit.

    Attributes:
        gravity: whether its accelerations are believed, by their mean.
        pushes: whether they are, by what the vehicle's speed does.
        turns: whether its yaw rates are.
    """

    def __init__(self) -> None:
        self.gravity = GravityWatch()
        self.pushes = PushWatch()
        self.turns = TurnWatch()

    @property
    def believes_acceleration(self) -> bool:
        """Whether its accelerations are believed."""
        return self.gravity.is_believed and self.pushes.is_believed

    def doubts(self) -> dict[str, str]:
        """Return what is not believed, and why."""
        told = {"acceleration": self.gravity.doubt or self.pushes.doubt, "yaw rate": self.turns.doubt}
        return {what: why for what, why in told.items() if why is not None}
