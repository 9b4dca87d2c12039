"""What can be set about whether the vehicle's data can be believed."""

from enum import Enum
from typing import Annotated

from pydantic import Field

from link.program.toml_config import NotNegative, Positive, StrictModel


class ReceiverFrames(Enum):
    """What a user says of the drone's and the vehicle's receivers: whether their positions are in one frame."""

    AUTO = "auto"  # while both have fixed carrier phases, which is taken for corrections of one source
    ONE = "one"  # both are corrected by one base station or network
    APART = "apart"  # by two: the pad has to be seen


class IntegrityConfig(StrictModel):
    """What the vehicle's stamps, places, heights and headings must agree with."""

    # Whether the pad's place follows from both receivers' positions, or has to be seen.
    receiver_frames: ReceiverFrames = ReceiverFrames.AUTO
    fix_ahead_max_s: NotNegative = 0.05  # so far in the future a fix may be stamped: what clocks err by
    fix_ahead_hold_s: Positive = 1.0  # each fix of that time is; a late or early one says nothing
    # Share of one quantity's measurements of 10 s that the estimator rejects; over poor receivers 0.02 at most.
    rejected_share_max: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    # Harder, nothing on wheels changes its velocity: tyres grip dry asphalt with a friction of 1.2 at most. Sightings
    # that are stamped 0.05 s wrong do, for the drone's own turns move them, and it turns to follow.
    acceleration_max_m_s2: Positive = 12.0
    acceleration_hold_s: Positive = 0.1  # three pictures at 30 Hz: a single one may err
    # A vehicle this near whose road is said to be farther above or below the ground that the drone took off from than a
    # step and a hill can be, has a receiver with another height: a bank beside the road, and a steep street.
    ground_within_m: Positive = 30.0
    ground_step_max_m: Positive = 1.5
    ground_slope_max: NotNegative = 0.07  # metres for each metre between them
    # From this speed on the heading is compared with the course. So far off, the pad is 0.3 m beside its place at the
    # end of the benchmark's lever arm of 1.3 m; side slip and mounting are less.
    course_speed_min_m_s: Positive = 2.0
    heading_off_max_rad: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.21
    # A vessel's heading may be off by as much more as wind and current of this speed turn its course: 3 knots, as
    # spring tides run in estuaries. At 2.2 m/s over ground these are 43 degrees, at 10 m/s 9.
    vessel_drift_max_m_s: NotNegative = 1.5
