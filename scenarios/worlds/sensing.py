"""The sensors and the links of a world."""

from scenarios.config import (
    ChannelConfig,
    ClockConfig,
    FixConfig,
    ImuConfig,
    LinkConfig,
    OwnStateConfig,
    PatternConfig,
    RangeConfig,
    SensorsConfig,
    VelocityConfig,
)
from scenarios.worlds.draws import Draws


def draw_sensors(draws: Draws) -> SensorsConfig:
    """Return the sensors of a world; what a world does not have is drawn all the same."""
    fix, velocity, imu, pattern = _fix(draws), _velocity(draws), _imu(draws), _pattern(draws)
    return SensorsConfig(
        fix=fix,
        velocity=velocity if draws.yes("sensors.velocity") else None,
        imu=imu if draws.yes("sensors.imu") else None,
        pattern=pattern if draws.yes("sensors.pattern") else None,
        frame_offset_m=draws.number("sensors.frame_offset_m"),
        clock=ClockConfig(
            offset_max_s=draws.number("sensors.clock_offset_s"), drift_max=draws.number("sensors.clock_drift")
        ),
        own_state=_own_state(draws),
        range_finder=RangeConfig(
            white_m=draws.number("sensors.range_white_m"),
            min_m=draws.number("sensors.range_min_m"),
            max_m=draws.number("sensors.range_max_m"),
        ),
    )


def _fix(draws: Draws) -> FixConfig:
    return FixConfig(
        rate_hz=draws.number("sensors.fix_rate_hz"),
        delay_s=draws.number("sensors.fix_delay_s"),
        jitter_s=draws.number("sensors.fix_jitter_s"),
        loss=draws.number("sensors.fix_loss"),
        white_m=draws.number("sensors.fix_white_m"),
        bias_m=draws.number("sensors.fix_bias_m"),
        bias_tau_s=draws.number("sensors.fix_bias_s"),
    )


def _velocity(draws: Draws) -> VelocityConfig:
    return VelocityConfig(
        rate_hz=draws.number("sensors.fix_rate_hz"),
        delay_s=draws.number("sensors.fix_delay_s"),
        jitter_s=draws.number("sensors.fix_jitter_s"),
        loss=draws.number("sensors.fix_loss"),
        white_m_s=draws.number("sensors.velocity_white_m_s"),
    )


def _imu(draws: Draws) -> ImuConfig:
    white_m_s2 = draws.number("sensors.acceleration_white_m_s2")
    return ImuConfig(
        rate_hz=50.0,  # the benchmark's, and what an autopilot or a ROS 2 driver sends by default; a choice
        delay_s=draws.number("sensors.imu_delay_s"),
        heading_white_rad=draws.number("sensors.heading_white_rad"),
        heading_bias_rad=draws.number("sensors.heading_bias_rad"),
        heading_bias_tau_s=draws.number("sensors.heading_bias_s"),
        yaw_rate_white_rad_s=draws.number("sensors.yaw_rate_white_rad_s"),
        acceleration_white_m_s2=white_m_s2 if draws.yes("sensors.acceleration") else None,
        acceleration_bias_m_s2=draws.number("sensors.acceleration_bias_m_s2"),
    )


def _pattern(draws: Draws) -> PatternConfig:
    dropout = draws.number("sensors.pattern_dropout_share")
    return PatternConfig(
        rate_hz=draws.number("sensors.pattern_rate_hz"),
        delay_s=draws.number("sensors.pattern_delay_s"),
        range_share=draws.number("sensors.pattern_range_share"),
        white_rad=draws.number("sensors.pattern_white_rad"),
        range_min_m=draws.number("sensors.pattern_range_min_m"),
        range_max_m=draws.number("sensors.pattern_range_max_m"),
        half_field_of_view_rad=draws.number("sensors.pattern_half_view_rad"),
        dropout_share_range=(dropout, dropout),
        dropout_mean_s=draws.number("sensors.pattern_dropout_s"),
    )


def _own_state(draws: Draws) -> OwnStateConfig:
    step_m = draws.number("sensors.origin_step_m") * draws.yes("sensors.origin_step")
    at_s = draws.number("sensors.origin_step_at_s")
    return OwnStateConfig(
        position_std_m=draws.number("sensors.own_position_std_m"),
        height_std_m=draws.number("sensors.own_height_std_m"),
        velocity_std_m_s=draws.number("sensors.own_velocity_std_m_s"),
        origin_step_range_m=(step_m, step_m),
        origin_step_at_s=at_s,
    )


def draw_link(draws: Draws) -> LinkConfig:
    """Return the links of a world; the detector is on the drone, so its link is as good as the companion's own."""
    return LinkConfig(mavlink=_channel(draws, "mavlink"), zenoh=_channel(draws, "zenoh"))


def _channel(draws: Draws, name: str) -> ChannelConfig:
    outage_s = draws.number(f"link.{name}_outage_s") * draws.yes(f"link.{name}_outage")
    return ChannelConfig(
        delay_s=draws.number(f"link.{name}_delay_s"),
        jitter_s=draws.number(f"link.{name}_jitter_s"),
        loss=draws.number(f"link.{name}_loss"),
        outage_range_s=(outage_s, outage_s),
        outage_at_s=draws.number(f"link.{name}_outage_at_s"),
    )
