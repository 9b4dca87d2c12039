"""What a landing by the autopilot itself depends on, its detection, and the motors' stop after it, in SI units."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class PrecisionSettings:
    """What the PLND parameters amount to; `moving` is bit 0 of PLND_OPTIONS."""

    enabled: bool = False
    moving: bool = False
    sinks_within_m: float = 2.5


NO_PRECISION = PrecisionSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetSettings:
    """What the PLD parameters amount to.

    Attributes:
        lost_s: after which a target is lost.
        within_m: of the target, north and east, where it sinks.
        final_m: above the target, below which it lands where that was lost.
        search_m: above home, from where it looks for it.
        search_s: how long.
        searches_max: how often.
    """

    lost_s: float = 5.0
    within_m: float = 0.2
    final_m: float = 0.1
    search_m: float = 10.0
    search_s: float = 10.0
    searches_max: int = 3


PX4_TARGET = TargetSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class LandSettings:
    """Of a landing.

    Attributes:
        approach_m_s: sink rate high above home.
        descent_m_s: near the ground.
        slow_below_m: above home, where near the ground begins.
        precision: by LANDING_TARGET, in the mode that lands.
        target: by LANDING_TARGET, in a mode of its own.
    """

    approach_m_s: float
    descent_m_s: float
    slow_below_m: float
    precision: PrecisionSettings = NO_PRECISION
    target: TargetSettings = PX4_TARGET


@dataclass(frozen=True, slots=True, kw_only=True)
class LandDetectorSettings:
    """Of the land detector.

    Attributes:
        after_s: how long the signs of a landing must hold.
        speed_max_m_s: horizontal, over ground, above which no landing is detected.
        sink_max_m_s: vertical, over ground, above which no landing is detected.
        sink_asked_m_s: least downward velocity setpoint of a landing.
        tilt_max_rad: a drone that is asked to lean farther is not landed; None does not look.
        acceleration_max_m_s2: nor one that accelerates more; None does not look.
    """

    after_s: float
    speed_max_m_s: float
    sink_max_m_s: float
    sink_asked_m_s: float
    tilt_max_rad: float | None = None
    acceleration_max_m_s2: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DisarmSettings:
    """When the motors stop by themselves: after a landing, after one by a landing mode, after arming; None never."""

    landed_s: float | None
    after_landing_mode_s: float | None
    idle_s: float | None
