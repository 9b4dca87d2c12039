"""When a descent forecasts its contact."""

from itertools import cycle

import pytest

from companion.landing.touchdown import contact_forecast
from companion.situation.phases import Phase
from link.messages import ContactForecast
from link.records import replace
from tests.companion.facts import forecast_of
from tests.companion.world import CONFIG, PAD_HEIGHT_M, Flight, reached


@pytest.mark.slow
def test_contact_is_forecast_ten_times_a_second_and_in_each_step_below_the_commit_height() -> None:
    flight = reached(Phase.DESCEND)
    low_m = PAD_HEIGHT_M + CONFIG.descent.commit_height_m + CONFIG.touchdown.gear_height_m
    high: list[bool] = []
    low: list[bool] = []
    while flight.phase is Phase.DESCEND:
        before_ns, steps = flight.memory.forecast.made_ns, high if flight.own.position_enu_m[2] > low_m else low
        flight.step()
        steps.append(flight.memory.forecast.made_ns != before_ns)
    assert sum(high) == pytest.approx(0.2 * len(high), abs=2.0)
    assert len(low) > 20
    assert all(low[1:-1])


RISK = CONFIG.descent.risk.begins_max


def descends_by(forecasts: list[ContactForecast], monkeypatch: pytest.MonkeyPatch) -> Flight:
    """For three seconds from the height of alignment on, by these forecasts in turn."""
    flight, made = reached(Phase.DESCEND), cycle(forecasts)
    monkeypatch.setattr(contact_forecast, "forecast_contact", lambda *_: next(made))
    flight.run(6.0)
    return flight


def test_risk_that_is_small_for_a_moment_is_no_quiet_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    flight = descends_by([forecast_of(2.4 * RISK, 2.0), forecast_of(0.2 * RISK, 2.0)], monkeypatch)
    assert not flight.memory.forecast.has_begun
    assert flight.memory.forecast.risk == pytest.approx(1.3 * RISK, rel=0.2)


def test_ways_on_that_do_not_come_to_a_contact_tell_nothing_of_its_risk(monkeypatch: pytest.MonkeyPatch) -> None:
    unseen = replace(forecast_of(0.0, 2.0), broken_off=0.9)
    assert not descends_by([unseen], monkeypatch).memory.forecast.has_begun


def test_risk_is_of_the_contacts_that_come(monkeypatch: pytest.MonkeyPatch) -> None:
    half = replace(forecast_of(0.7 * RISK, 2.0), broken_off=0.5)
    assert descends_by([half], monkeypatch).memory.forecast.risk == pytest.approx(1.4 * RISK)


def test_descent_of_little_risk_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    flight = reached(Phase.DESCEND)
    monkeypatch.setattr(contact_forecast, "forecast_contact", lambda *_: forecast_of(0.5 * RISK, 2.0))
    flight.run_until(Phase.TOUCHDOWN)
    assert flight.history[-2:] == [Phase.DESCEND, Phase.TOUCHDOWN]
