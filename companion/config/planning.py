"""Numbers of the guidance laws, each with its unit in its name and where it comes from."""

import math
from enum import Enum
from typing import Annotated, Self

from pydantic import Field, model_validator

from link.program.toml_config import POSITIVE_MIN, StrictModel

Positive = Annotated[float, Field(ge=POSITIVE_MIN, le=1e6)]
NotNegative = Annotated[float, Field(ge=0.0, le=1e6)]
Fraction = Annotated[float, Field(gt=0.0, lt=1.0)]
PlannedTime = Annotated[float, Field(ge=0.01, le=10.0)]
"""Longer than any approach takes is a mistake: with a shortest way of hours the drone arms and does not rise."""


class GuidanceKind(Enum):
    """Which guidance law plans."""

    MPC = "mpc"  # preview of the target, limits, time-optimal intercept
    MPC_REPORT = "mpc_report"  # the source report's
    PN = "pn"  # proportional navigation after Borowczyk et al. 2017


class SolverKind(Enum):
    """Which QP solver."""

    DAQP = "daqp"  # dual active set: exact, some 60 us for a plan
    OSQP = "osqp"  # operator splitting, polished: some 70 times as long; to compare with


class ReportReading(Enum):
    """Which reading of the source report's MPC; its text and its reference simulation differ."""

    REFERENCE_SIMULATION = "reference_simulation"  # 10 and 2 steps, weights squared, input change weighed
    STATED = "stated"  # 1 s and 0.2 s, weights as printed, input weighed


_BLOCKS_MAX, _NODES_MAX = 40, 200
"""Of a plan: 60 blocks take ten times as long as the 13 of the default, and a period is 20 ms."""


class MpcConfig(StrictModel):
    """The default law; the weights were chosen by measurement of overshoot, time and noise."""

    solver: SolverKind = SolverKind.DAQP
    moves_s: tuple[Annotated[float, Field(ge=0.01, le=1e4)], ...] = (
        0.02,
        0.04,
        0.06,
        0.08,
        0.1,
        0.14,
        0.18,
        0.22,
        0.28,
        0.34,
        0.4,
        0.5,
        0.64,
    )  # blocks
    node_spacing_max_s: Annotated[float, Field(ge=0.01, le=1e4)] = 0.16  # longer blocks are split for costs and bounds
    position_weight: Positive = 1.0  # 1/m^2, the scale of all weights
    velocity_weight: NotNegative = 0.3  # s^2/m^2
    acceleration_weight: NotNegative = 0.005  # s^4/m^2
    jerk_weight: Positive = 0.0003  # s^6/m^2; bandwidth (position / jerk weight)^(1/6) = 3.9 rad/s
    slack_weight: Positive = 1e3  # exact penalty on the largest excess over a soft limit
    # Over a pad a plan sinks at most at its height by this and `touchdown.sink_max_m_s`: 1 / `descent.sink.gain_hz`.
    touch_time_s: PlannedTime = 1.0
    intercept_fraction: Fraction = 0.92  # of the acceleration limit that intercepts are planned with
    intercept_time_min_s: PlannedTime = 1.4  # shorter ways are slowed down to this: the law is linear near the target
    axes_time_s: Positive = 1.0  # a relative speed turns the major axis like the distance it covers in this time

    @model_validator(mode="after")
    def _can_be_solved_in_time(self) -> Self:
        nodes = sum(math.ceil(move_s / self.node_spacing_max_s) for move_s in self.moves_s)
        if not 1 <= len(self.moves_s) <= _BLOCKS_MAX or nodes > _NODES_MAX:
            raise ValueError(
                f"moves_s must have 1 to {_BLOCKS_MAX} blocks, split into at most {_NODES_MAX} nodes, "
                f"not {len(self.moves_s)} and {nodes}"
            )
        return self


class ReportMpcConfig(StrictModel):
    """The source report's law, equations 12 to 14, and its reference simulation."""

    reading: ReportReading = ReportReading.REFERENCE_SIMULATION
    velocity_factor: Positive = 1.2  # without it the reference never caught up


class PnConfig(StrictModel):
    """Proportional navigation far away and proportional-derivative control near.

    Source: Borowczyk et al. 2017, "Autonomous Landing of a Quadcopter on a High-Speed Ground Vehicle".
    """

    navigation_gain: Positive = 3.0  # the paper's lambda; 3 minimises the effort on a straight target
    closing_gain_1_s2: Positive = 1.0  # of the distance, along the line of sight
    closing_damping_1_s: Positive = 2.0  # of the closing speed; critical damping
    near_gain_1_s2: Positive = 4.0  # of the position error, near
    near_damping_1_s: Positive = 4.0  # of the velocity error, near; critical damping
    near_distance_m: Positive = 5.0  # at which it changes to near; back again at 1.5 times that
    far_hysteresis: Annotated[float, Field(gt=1.0, le=10.0)] = 1.5


class LandingStyle(Enum):
    """The way from the waiting point onto the pad."""

    STAGED = "staged"  # chase above the vehicle, align, descend inside the cone, switch off
    DIRECT = "direct"  # the pad's centre is the target from the start, contact or not; the source report


class GuidanceConfig(StrictModel):
    """The way onto the pad, the guidance law and the numbers of all of them."""

    kind: GuidanceKind = GuidanceKind.MPC
    style: LandingStyle = LandingStyle.STAGED
    mpc: MpcConfig = MpcConfig()
    mpc_report: ReportMpcConfig = ReportMpcConfig()
    pn: PnConfig = PnConfig()
