"""When a descent forecasts its contact."""

import pytest

from companion.situation.phases import Phase
from tests.companion.world import CONFIG, PAD_HEIGHT_M, reached


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
