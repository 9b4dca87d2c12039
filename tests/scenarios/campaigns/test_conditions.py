"""The columns about conditions, by hand."""

from typing import Any

import pytest

from scenarios.campaigns.conditions import conditions_of, disturbances_before
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario


def scenario(**values: Any) -> Scenario:
    return load_scenario("straight_5").model_copy(update=values)


def test_conditions_are_those_of_the_scenario() -> None:
    plain = load_scenario("straight_5+sensors=nominal+link=nominal+wind=moderate")
    found = conditions_of(plain)
    fix = plain.sensors.fix
    assert found["data_age_s"] == pytest.approx(fix.delay_s + plain.link.zenoh.delay_s + 0.5 / fix.rate_hz)
    assert found["wind_mean_m_s"] == plain.wind.mean_m_s > 0.0
    assert found["pad_side_m"] == 1.5


def test_pad_counts_by_its_shorter_side() -> None:
    vehicle = scenario().vehicle.model_copy(update={"pad_size_m": (1.9, 1.2)})
    assert conditions_of(scenario(vehicle=vehicle))["pad_side_m"] == 1.2


@pytest.mark.parametrize(("at_s", "peak_m_s"), [(13.9, 0.0), (14.1, 6.5), (17.2, 6.5), (20.1, 0.0)])
def test_gust_counts_while_it_blows_and_three_seconds_on(at_s: float, peak_m_s: float) -> None:
    wind = scenario().wind.model_copy(update={"gust_m_s": 6.5, "gust_duration_s": 3.0})
    gusty = scenario(wind=wind).with_run(disturbed_between_s=(14.0, 14.0))
    assert disturbances_before(gusty, 1, at_s)["before_gust_m_s"] == peak_m_s


@pytest.mark.parametrize(("at_s", "silent_s"), [(13.0, 0.0), (14.4, 0.4), (15.0, 0.8), (17.3, 0.5), (18.0, 0.0)])
@pytest.mark.parametrize("channel", ["zenoh", "mavlink"])
def test_silence_counts_as_far_as_it_is_within_the_three_seconds(channel: str, at_s: float, silent_s: float) -> None:
    out = scenario().link.zenoh.model_copy(update={"outage_range_s": (0.8, 0.8)})
    link = scenario().link.model_copy(update={channel: out})
    silent = scenario(link=link).with_run(disturbed_between_s=(14.0, 14.0))
    assert disturbances_before(silent, 1, at_s)["before_silence_s"] == pytest.approx(silent_s)
