"""When what happens once in a run happens: an outage, a gust, a step of the autopilot's origin."""

from scenarios.config import ChannelConfig, Scenario
from scenarios.simulation.noise import Seed, named_rng

Span = tuple[int, int]


def instant_s(scenario: Scenario, seed: Seed, name: str, at_s: float | None) -> float:
    """Return when the disturbance `name` begins, in seconds since the start of the simulation; `at_s` None draws it."""
    return (
        at_s if at_s is not None else float(named_rng(seed, f"{name} instant").uniform(*scenario.disturbed_between_s))
    )


def outages_ns(channel: ChannelConfig, scenario: Scenario, seed: Seed, name: str, start_ns: int) -> list[Span]:
    """Return the outages of the link `name`, from start to end in UTC: one, or none where it never fails.

    Args:
        channel: of the link.
        scenario: says when.
        seed: draws instant and length.
        name: of the link.
        start_ns: UTC at the start of the simulation.
    """
    shortest_s, longest_s = channel.outage_range_s
    if longest_s == 0.0:
        return []
    begin_ns = start_ns + round(instant_s(scenario, seed, f"{name} outage", channel.outage_at_s) * 1e9)
    length_s = float(named_rng(seed, f"{name} outage").uniform(shortest_s, longest_s))
    return [(begin_ns, begin_ns + round(length_s * 1e9))]
