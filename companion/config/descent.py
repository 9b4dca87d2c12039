"""What can be set about the alignment over the pad and the descent onto it."""

from typing import Annotated

from pydantic import Field

from link.program.toml_config import NotNegative, Positive, StrictModel


class AlignmentConfig(StrictModel):
    """Over the pad, before the descent."""

    height_m: Positive = 1.5  # above the pad
    begin_distance_m: Positive = 1.5  # horizontal, at which alignment begins
    distance_m: Positive = 0.25
    speed_m_s: Positive = 0.5
    hold_s: NotNegative = 0.2
    time_limit_s: Positive = 30.0


class SinkConfig(StrictModel):
    """How fast the drone sinks towards the pad, and how far."""

    rate_max_m_s: Positive = 1.2
    gain_hz: Positive = 1.0  # sink rate per metre of height left
    contact_rate_m_s: Positive = 0.45  # S2 asks for 0.7 at most
    press_depth_m: Positive = 0.5  # how far below the pad the setpoint goes on, so that contact is firm


class ConeConfig(StrictModel):
    """The cone above the pad that the drone descends in."""

    radius_at_pad_m: Positive = 0.3  # 0.2 of the width of a pad narrower than 1.5 m
    slope: NotNegative = 0.35  # metres of radius per metre of height


class WaitConfig(StrictModel):
    """Where the drone waits above the pad, and what for.

    It waits beside the cone, too, for a vehicle that drives unevenly, and for its own sway.
    """

    height_m: Positive = 0.85  # a heaving roof and a late stop leave the drone above `abort.near_height_m`
    # Over a pad that only the detector places, which is blind below 0.5 m: what is known late grows old below.
    height_coarse_m: Positive = 0.7
    # While the vehicle brakes or speeds up harder than this, as the drone must lean for.
    speed_change_max_m_s2: Positive = 1.2
    # Above this a pad that only the detector places is waited above, too, until it is within the alignment's distance:
    # what is made up for below is speed against the pad at contact, and the detector is blind there.
    centred_height_m: NotNegative = 0.5
    # Faster than this against the pad it waits there, too, to settle (S2 asks for 0.5 at contact), and faster
    # than so many standard deviations of the vehicle's velocity, for of a speed that is hardly known nothing is gained.
    speed_m_s: Positive = 0.4
    speed_stds: NotNegative = 1.5


class UnevenConfig(StrictModel):
    """How a vehicle drives that may surprise the drone, and how long that is waited for."""

    # So far off, in hindsight, the vehicle's speed may have been believed; S1 asks for 1.0 m/s at contact. Beyond
    # it the descent waits until the vehicle stands, or has driven as expected for as long as from one stop to the next.
    surprise_speed_m_s: Positive = 0.7
    hard_brake_m_s2: Positive = 1.6  # over 2 s: surprises the drone, however fresh the data; `random` 0.7
    # A vehicle whose speed has changed like that in the last 15 s, and whose data are older than `age_s`, is waited
    # above, too: what it does in the last second is known too late. An even driver shows 0.1 m/s^2, `random` 0.7.
    acceleration_m_s2: Positive = 0.35
    winding_acceleration_m_s2: Positive = 0.8  # to the side; `figure_eight` shows 0.6 at 5 m/s and 1.2 at 7
    # A drone leans into a curve and levels in its last 0.3 s, which over such links comes 0.1 s early or late; with the
    # 6 degrees by which it sways there S1's 15 over trim are left for a curve of this.
    turning_acceleration_m_s2: Positive = 2.4
    age_s: NotNegative = 0.3
    stop_s: NotNegative = 4.0  # likewise, a vehicle that has stopped; `stop_and_go` departs after 3 s
    hold_s: NotNegative = 20.0  # `stop_and_go` brakes again 15 s later
    wait_max_s: NotNegative = 60.0  # for which it waits so without its time limit running: three surprises


class QuietConfig(StrictModel):
    """What is waited for above a deck whose motion the vehicle tells."""

    # Accepted: with so much probability a contact begun now may be unsafe, by its forecast. Published landings on decks
    # in waves are asked to be good in 95 % (docs/benchmark.md); what is riskier waits for a quieter moment, and is
    # broken off by the descent's time limit.
    unsafe_max: Annotated[float, Field(gt=0.0, le=1.0)] = 0.05


class UnseenConfig(StrictModel):
    """A pad that the vehicle's fixes are too coarse to place: it has to be seen."""

    # Standard deviation up to which it is landed on: half of what S1 allows. Its pattern must have been seen as lately
    # as that, while the drone and the vehicle's clock wander.
    std_max_m: Positive = 0.25
    hold_s: NotNegative = 1.5  # in the alignment, before it climbs to see more of the road
    # So often in one approach it has to be seen (again): 3 times at most in 60 landings over poor links.
    anew_max: Annotated[int, Field(ge=0, le=100)] = 10


class SwayConfig(StrictModel):
    """The drone's own sway that is waited for low above the pad."""

    # Lean beyond that of the last second, as an acceleration: 8.7 degrees of the 15 over trim that S1 allows. Low above
    # the pad the drone then waits at the commit height for the gust or the correction to pass.
    acceleration_max_m_s2: Positive = 1.5
    calm_hold_s: NotNegative = 0.25
    height_min_m: NotNegative = 0.1  # of the lowest foot, below which the contact comes before a stop


class DescentConfig(StrictModel):
    """From the alignment to the contact."""

    pad_width_min_m: Positive = 0.5  # narrower ones are refused: the cone would end narrower than 0.1 m
    stray_hold_s: NotNegative = 3.0  # beside the cone or too fast, but high enough to be aligned again
    strays_max: Annotated[int, Field(ge=0, le=20)] = 3  # so often in one approach, as retries: a gust may last
    commit_height_m: Positive = 0.35  # below this it lands rather than aborts
    # Accepted: an unsafe contact weighs as much as five more approaches. With more probability of one, by its forecast,
    # a committed descent turns back as long as it can stop sinking above the pad.
    turns_back_unsafe: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    time_limit_s: Positive = 30.0
    alignment: AlignmentConfig = AlignmentConfig()
    sink: SinkConfig = SinkConfig()
    cone: ConeConfig = ConeConfig()
    wait: WaitConfig = WaitConfig()
    uneven: UnevenConfig = UnevenConfig()
    unseen: UnseenConfig = UnseenConfig()
    sway: SwayConfig = SwayConfig()
    quiet: QuietConfig = QuietConfig()
