"""What can be set about the last moments above the pad, the contact and the switching off of the motors."""

from typing import Annotated

from pydantic import Field, ValidationInfo, field_validator

from link.program.toml_config import NotNegative, Positive, StrictModel


class RangeFinderConfig(StrictModel):
    """What a range finder that looks down says of the pad."""

    height_m: NotNegative = 0.12  # of the range finder above the feet
    std_m: Positive = 0.03  # of a reading; data sheets of small laser range finders state 0.01 to 0.06 m
    off_max_m: Positive = 0.4  # what it sees may be nearer than the pad by so much before a landing is broken off
    off_hold_s: NotNegative = 0.3  # so long readings and attitude belong together
    contact_height_max_m: Positive = 0.15  # seen under the feet at which it still agrees with a contact
    disputed_hold_s: NotNegative = 1.0  # for which all other signs have to agree, when it does not


class LevelConfig(StrictModel):
    """The drone turns less than the deck below a height, to touch down level."""

    height_m: NotNegative = 0.08
    late_stds: NotNegative = 1.5  # of the link's delay, by which it begins earlier: so late a setpoint may be
    # Beyond steady flight, for which a gust of 3 m/s is taken, too: that takes 0.7 of the 1.7 m/s^2 (10 degrees) of S2.
    acceleration_m_s2: Positive = 1.0
    speed_max_m_s: Positive = 0.35  # that this may bring against the pad; S2 asks for 0.5 at contact


class LostConfig(StrictModel):
    """A pad that is not there, and a contact that was none."""

    # So far below the pad's surface for so long, and nothing was touched: it is not there. Heights are off by 0.4 m
    # over poor receivers, and a contact that the range finder disputes is believed after its own hold.
    missed_depth_m: Positive = 0.2
    missed_hold_s: Positive = 2.0
    height_m: Positive = 0.6  # higher than this after a contact is a bounce or a slide
    hold_s: NotNegative = 5.0  # higher than `touchdown.height_max_m` for so long is none either, or the motors stop


class TouchdownConfig(StrictModel):
    """The signs of a contact, what is pressed, and what shows that there was none."""

    gear_height_m: NotNegative = 0.12  # from the feet to the point whose position the autopilot reports
    foot_radius_m: NotNegative = 0.2  # of the feet about the drone's axis: the lowest of a leaning drone touches first
    # Of the feet on the pad, the tangent of the slope on which the drone slides off with its motors off: rubber on dry
    # painted metal 0.8, on a wet one 0.5. Where the air pushes harder than that, no landing is tried.
    gear_friction: Annotated[float, Field(gt=0.0, le=2.0)] = 0.8
    height_max_m: Positive = 0.35  # estimated height over the pad at which a contact is believed
    blocked_depth_m: Positive = 0.06  # how far the setpoint has sunk below the drone
    blocked_speed_m_s: Positive = 0.2  # relative vertical speed that counts as standing
    # Relative vertical speed that counts as standing where the drone is pressed down and the range finder sees the pad
    # at its feet. A drone that is pressed down in the air is seen to fall at this sink rate: the signs of a contact
    # have to agree until it would have come to it.
    pressed_speed_m_s: Positive = 0.5
    falling_acceleration_m_s2: Positive = 3.5  # downwards faster than this nothing stands on a pad; half of the presses
    # Horizontally: no flying changes the velocity so fast, and no hold is waited for. Thrust of twice the weight and
    # drag at 30 m/s are 19.6 + 5.0 m/s^2. A drone that leans by 45 degrees makes 9.81 in any flight.
    jolt_m_s2: Annotated[float, Field(ge=9.81, le=1e4)] = 25.0
    stopped_hold_s: Positive = 0.3  # after a jolt, pressed down without falling: in the air it would sink at 2 m/s then
    sink_max_m_s: Positive = 0.7  # that the gear takes (S2), of a drone that is pressed down and was still in the air
    # Downwards, at most, while the signs of a contact hold, and once they are believed: nearly the whole weight.
    try_acceleration_m_s2: Annotated[float, Field(ge=0.0, le=9.0)] = 5.0
    press_acceleration_m_s2: Annotated[float, Field(ge=0.0, le=9.0)] = 9.0
    range_finder: RangeFinderConfig = RangeFinderConfig()
    level: LevelConfig = LevelConfig()
    lost: LostConfig = LostConfig()

    @field_validator("try_acceleration_m_s2", "press_acceleration_m_s2")
    @classmethod
    def _would_fall(cls, value: float, info: ValidationInfo) -> float:
        falling_m_s2 = info.data.get("falling_acceleration_m_s2")
        if falling_m_s2 is not None and value <= falling_m_s2:
            raise ValueError(f"it must be more than falling_acceleration_m_s2, {falling_m_s2:g}, to tell pad from air")
        return value
