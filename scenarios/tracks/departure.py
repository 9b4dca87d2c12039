"""When the vehicle of any track starts."""

from link.program.toml_config import NotNegative, Positive, StrictModel

Waypoint = tuple[float, float]
"""East and north in W, m."""


class Departure(StrictModel):
    """When the vehicle starts: `departs_s` after the drone has hovered at the waiting point, or after the start."""

    wait_for_drone: bool = True
    hover_radius_m: Positive = 2.5  # of a drone whose own place may be off by three times 0.5 m and more
    hover_s: NotNegative = 1.0
    departs_s: NotNegative = 1.0
