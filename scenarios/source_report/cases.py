"""What the source report published: the outcomes of its scenarios and the step responses of its regulator.

Source: Ghribi, Polytechnique Montréal, 2022, sections 3 and 6. Times count from the start of its simulation, in which
the vehicle stands for 5 s and then drives; places are the vehicle's. A landing is a distance of 0.7 m.
"""

from dataclasses import dataclass

from link.program.toml_config import StrictModel

STANDS_S = 5.0
"""How long the vehicle stands before it drives, and when the drone begins its landing."""
LANDED_M = 0.7
"""3-D distance of the drone from the vehicle's centre that is a landing."""


class Place(StrictModel):
    """When and where the report's drone landed."""

    t_s: float
    x_m: float
    y_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class PublishedCase:
    """A scenario and its outcome; None where it did not land."""

    scenario: str
    outcome: str
    landing: Place | None = None


CASES = (
    PublishedCase(
        scenario="report_1", outcome="lands after 11 s at x = 4.3 m", landing=Place(t_s=11.0, x_m=4.3, y_m=0.0)
    ),
    PublishedCase(scenario="report_2", outcome="never catches up"),
    PublishedCase(
        scenario="report_3", outcome="lands after 13.5 s at (30, -9) m", landing=Place(t_s=13.5, x_m=30.0, y_m=-9.0)
    ),
    PublishedCase(scenario="report_4", outcome="not before the road ends"),
    PublishedCase(scenario="report_1_10", outcome="unstable"),
    PublishedCase(scenario="report_3_10", outcome="unstable"),
)

SETTLING_S = {"x": 1.41, "y": 1.33, "z": 1.53, "yaw": 0.62}
"""2 % settling times of a unit step, linear model."""
OVERSHOOT = "8 to 11 %"
"""Of the same responses; from the same matrices follow 11.2, 10.9, 8.0 and 8.1 %."""
