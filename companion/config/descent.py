"""What can be set about the alignment over the pad and the descent onto it."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from link.program.toml_config import NotNegative, Positive, StrictModel


class AlignmentConfig(StrictModel):
    """Over the pad, before the descent."""

    height_m: Positive = 1.5  # above the pad
    begin_distance_m: Positive = 1.5  # horizontal, at which alignment begins
    time_limit_s: Positive = 30.0


class SinkConfig(StrictModel):
    """How fast the drone sinks towards the pad, and how far."""

    rate_max_m_s: Positive = 1.2
    # Sink rate per metre of height left: as PX4's MPC_Z_P and ArduPilot's PSC_POSZ_P go to a height.
    gain_hz: Positive = 1.0
    contact_rate_m_s: Positive = 0.45  # S2 asks for 0.7 at most
    press_depth_m: Positive = 0.5  # how far below the pad the setpoint goes on, so that contact is firm


class ConeConfig(StrictModel):
    """The cone above the pad that the drone descends in."""

    radius_at_pad_m: Positive = 0.3  # S2's limit; 0.2 of the width of a pad narrower than 1.5 m
    slope: NotNegative = 0.35  # metres of radius per metre of height


class WaitConfig(StrictModel):
    """Where the drone waits above the pad, and what for.

    It waits beside the cone, while it is faster than `abort.near_speed_max_m_s`, and for a risk that passes
    (`RiskConfig`).
    """

    height_m: Positive = 0.85  # a heaving roof and a late stop leave the drone above `abort.near_height_m`
    # Over a pad that only the detector places, which is blind below 0.5 m: what is known late grows old below.
    height_coarse_m: Positive = 0.7
    # Above this a pad that only the detector places is waited above, too, until it is within that distance: what is
    # made up for below is speed against the pad at contact, and the detector is blind there.
    centred_height_m: NotNegative = 0.5
    centred_distance_m: Positive = 0.25  # from the pad's middle; S2 allows 0.3 at contact


class RiskConfig(StrictModel):
    """Which risk of an unsafe contact, by its forecast, is accepted, and how long a smaller one is waited for."""

    # A contact is begun with at most so much. Published landings on decks in waves are asked to be good in 95 %
    # (docs/benchmark.md). What is riskier waits: for a quieter moment of a deck, for another one of a driver.
    begins_max: Annotated[float, Field(gt=0.0, le=1.0)] = 0.05
    # With more than so much the descent turns back until the drone stands: an unsafe contact weighs as much as five
    # more approaches.
    turns_back_min: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    # For which it waits without its time limit running: as long as what was seen of a driver is kept.
    wait_max_s: NotNegative = 60.0


class UnseenConfig(StrictModel):
    """A pad that the vehicle's fixes are too coarse to place: it has to be seen."""

    # Standard deviation up to which it is landed on: half of what S1 allows. Its pattern must have been seen as lately
    # as that, while the drone and the vehicle's clock wander.
    std_max_m: Positive = 0.25
    hold_s: NotNegative = 1.5  # in the alignment, before it climbs to see more of the road
    # So often in one approach it has to be seen (again): 3 times at most in 60 landings over poor links. So often, too,
    # the heading that places it may become vague.
    anew_max: Annotated[int, Field(ge=0, le=100)] = 10


class DescentConfig(StrictModel):
    """From the alignment to the contact."""

    stray_hold_s: NotNegative = 3.0  # beside the cone or too fast, but high enough to be aligned again
    strays_max: Annotated[int, Field(ge=0, le=20)] = 3  # so often in one approach, as retries: a gust may last
    commit_height_m: Positive = 0.35  # below this it lands rather than aborts
    time_limit_s: Positive = 30.0
    alignment: AlignmentConfig = AlignmentConfig()
    sink: SinkConfig = SinkConfig()
    cone: ConeConfig = ConeConfig()
    wait: WaitConfig = WaitConfig()
    risk: RiskConfig = RiskConfig()
    unseen: UnseenConfig = UnseenConfig()

    @model_validator(mode="after")
    def _commits_below_the_wait(self) -> Self:
        lowest_m = min(self.wait.height_m, self.wait.height_coarse_m)
        if self.commit_height_m >= lowest_m:
            raise ValueError(
                f"commit_height_m, {self.commit_height_m:g}, must be less than the heights of wait, {lowest_m:g}"
            )
        return self
