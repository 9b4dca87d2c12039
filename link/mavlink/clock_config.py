"""How the clocks of companion, autopilot and UTC are followed: the numbers of `clock_map`."""

from msgspec import Struct


class ClockConfig(Struct, frozen=True, kw_only=True):
    """How clocks are followed.

    Attributes:
        window_ns: pairs older than this are forgotten.
        pairs_max: so many are kept at most.
        drift_std: of an unknown clock against another; simulations were seen 1 to 2.5 % off.
        round_trip_std_ns: of the quickest round trip on a steady link; the autopilot's answer waits for its own loop.
        spread_share: of what the median round trip takes longer than the quickest, added to each one's deviation, as
            the quickest of a few is not free of jitter either. 0.1 makes the stated deviation match the true error
            for uniform jitter from 1 to 50 ms.
        system_time_std_ns: of a SYSTEM_TIME pair, cut to 1 ms: a uniform error of 1 / sqrt(12) ms.
        step_ns: a disagreement beyond what a pair explains, from which a clock is taken to have been set.
    """

    window_ns: int = 20_000_000_000
    pairs_max: int = 64
    drift_std: float = 0.02
    round_trip_std_ns: float = 300_000.0
    spread_share: float = 0.1
    system_time_std_ns: float = 300_000.0
    step_ns: int = 50_000_000


DEFAULT_CLOCK_CONFIG = ClockConfig()
