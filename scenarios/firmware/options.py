"""How a flight with a firmware's own simulation is made."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True, kw_only=True)
class FlyOptions:
    """How a flight is made.

    Attributes:
        mavlink: the companion's device.
        watch: device of a second link, for the simulation's truth.
        ship_speed_m_s: of ArduPilot's simulated ship, which then is the vehicle; None is the scenario's vehicle.
        seed: of the vehicle's sensors.
        folder: to be made for the flight.
        sortie: launch from the vehicle, follow and come home, instead of landing alone.
        record: write what goes in and out of the companion, and the truth, as MCAP.
    """

    mavlink: str
    watch: str
    ship_speed_m_s: float | None
    seed: int
    folder: Path
    sortie: bool = False
    record: bool = False
