"""Under which conditions a landing was flown, read from its scenario: columns that every cell has, drawn or not."""

from collections.abc import Iterable
from typing import Any

from scenarios.config import Scenario
from scenarios.scoring.circumstances import BEFORE_S
from scenarios.simulation.drone import sim_autopilot_config
from scenarios.simulation.noise import outages_ns

Columns = dict[str, Any]


def conditions_of(scenario: Scenario) -> Columns:
    """Return what of a scenario a landing is asked after.

    `data_age_s` is of a fix when the next one comes, on average: the receiver's delay, the link's and half a period.
    """
    fix, pad_m = scenario.sensors.fix, scenario.vehicle.pad_size_m
    return {
        "data_age_s": fix.delay_s + scenario.link.zenoh.delay_s + 0.5 / fix.rate_hz,
        "wind_mean_m_s": scenario.wind.mean_m_s,
        "pad_side_m": min(pad_m),
    }


def disturbances_before(scenario: Scenario, seed: int, at_s: float) -> Columns:
    """Return what of the air and the links disturbed the seconds before an instant.

    Args:
        scenario: that was flown.
        seed: of everything random in it.
        at_s: the instant, since the start of the simulation.

    Returns:
        `before_gust_m_s`, the peak of a gust that blew, 0 without one; `before_silence_s`, how long a link was out, the
        one from the vehicle or the one to the autopilot, whichever was longer.
    """
    wind = sim_autopilot_config(scenario, seed, instant=True).wind
    blew_s = _overlap_s(wind.gust_start_s, wind.gust_start_s + wind.gust_duration_s, at_s)
    link = scenario.link
    silences_s = [
        _silence_s(outages_ns(channel, scenario, seed, name, 0), at_s)
        for name, channel in (("mavlink", link.mavlink), ("zenoh", link.zenoh))
    ]
    return {
        "before_gust_m_s": wind.gust_m_s if blew_s > 0.0 else 0.0,
        "before_silence_s": max(silences_s),
    }


def _silence_s(outages_ns: Iterable[tuple[int, int]], at_s: float) -> float:
    return sum(_overlap_s(begin_ns * 1e-9, end_ns * 1e-9, at_s) for begin_ns, end_ns in outages_ns)


def _overlap_s(begin_s: float, end_s: float, at_s: float) -> float:
    """Return how much of a time span lies in the seconds before `at_s`."""
    return max(0.0, min(end_s, at_s) - max(begin_s, at_s - BEFORE_S))
