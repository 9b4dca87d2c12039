from typing import Any

from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import ChannelConfig, ClockConfig, OwnStateConfig, Scenario, WindConfig
from scenarios.falsify.simplify import details, without

HARD = load_scenario("brake_7+sensors=degraded+wind=gust+link=degraded")


def table(scenario: Scenario) -> dict[str, Any]:
    return scenario.model_dump(mode="json")


def test_scenario_without_any_detail_is_ideal() -> None:
    plain = without(HARD, details(HARD))
    assert plain is not None
    assert plain.wind == WindConfig()
    assert (plain.link.mavlink, plain.link.zenoh, plain.link.detector) == (ChannelConfig(),) * 3
    assert (plain.sensors.clock, plain.sensors.own_state) == (ClockConfig(), OwnStateConfig())
    assert (plain.sensors.fix.delay_s, plain.sensors.fix.bias_m, plain.sensors.frame_offset_m) == (0.0, 0.0, 0.0)
    assert details(plain) == []


def test_what_a_sensor_says_of_its_noise_stays() -> None:
    plain = without(HARD, details(HARD))
    assert plain is not None
    assert plain.sensors.fix.white_m == HARD.sensors.fix.white_m > 0.0


def test_nothing_changes_where_nothing_is_left_out() -> None:
    assert without(HARD, []) == HARD


def test_only_what_is_left_out_changes() -> None:
    calmer = without(HARD, [("wind", "gust_m_s"), ("link", "mavlink", "loss")])
    assert calmer is not None
    expected = table(HARD)
    expected["wind"]["gust_m_s"] = 0.0
    expected["link"]["mavlink"]["loss"] = 0.0
    assert table(calmer) == expected
