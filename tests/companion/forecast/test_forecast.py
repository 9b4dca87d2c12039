"""The forecast of a step: probabilities that make one, by the limits that landings are scored by."""

import dataclasses

import numpy as np
import pytest

from companion.core.data import VehicleEstimate
from companion.forecast.chances import S1, S2, ContactLimits, sum_up
from companion.situation.phases import Phase
from scenarios.scoring.touchdown import S1_LIMITS, S2_LIMITS, Limits
from tests.companion.world import PAD_HEIGHT_M, Flight, KnownVehicle


@pytest.mark.parametrize(("companions", "scored"), [(S1, S1_LIMITS), (S2, S2_LIMITS)])
def test_the_limits_are_those_by_which_landings_are_scored(companions: ContactLimits, scored: Limits) -> None:
    assert {name: getattr(companions, name) for name in companions.__struct_fields__} == dataclasses.asdict(scored)


def test_each_sample_counts_with_its_weight_under_the_worst_of_its_limits() -> None:
    ends = np.array(
        [
            [1.0, 0.5, 0.1, 0.1, 0.45, 0.01],  # S2
            [1.0, 0.6, 0.4, 0.1, 0.45, 0.01],  # S1
            [1.0, 0.7, 0.6, 1.9, 0.45, 0.01],  # unsafe, by its speed most of all
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ]
    )
    found = sum_up(ends, np.array([0.5, 0.2, 0.1, 0.2]), room_m=0.55)
    assert (found.s2, found.s1, found.unsafe, found.broken_off) == pytest.approx((0.5, 0.7, 0.1, 0.2))
    assert (found.misses_speed, found.misses_position) == pytest.approx((0.1, 0.0))
    assert found.in_s == pytest.approx((0.5 * 0.5 + 0.2 * 0.6 + 0.1 * 0.7) / 0.8)


def test_beside_a_narrow_pad_no_contact_is_safe() -> None:
    end = np.array([[1.0, 0.5, 0.2, 0.1, 0.45, 0.01]])
    assert sum_up(end, np.ones(1), room_m=0.15).misses_position == 1.0


class TellingVehicle(KnownVehicle):
    """One whose estimate has a covariance, as little as RTK leaves."""

    def estimate(self, _memory: int | None, t_ns: int) -> VehicleEstimate | None:
        return VehicleEstimate(
            t_ns=t_ns,
            position_enu_m=self.at(t_ns),
            velocity_enu_m_s=np.array(self.velocity_enu_m_s),
            acceleration_enu_m_s2=np.zeros(3),
            covariance=np.diag([0.02**2] * 3 + [0.02**2] * 3 + [0.05**2] * 3),
            yaw_rad=self.yaw_rad,
            yaw_rate_rad_s=0.0,
        )


@pytest.mark.slow
def test_a_descent_is_forecast_ten_times_a_second_and_surely_lands_on_a_vehicle_that_is_known() -> None:
    flight = Flight(vehicle=TellingVehicle((-20.0, 0.4, PAD_HEIGHT_M), (4.0, 0.0, 0.0), std_m=0.02))
    flight.start_and_reach(Phase.DESCEND)
    statuses, committed_m = [flight.step().status], []
    while flight.phase is Phase.DESCEND:
        again = flight.copy()
        statuses.append(flight.step().status)
        if flight.memory.forecast.is_committed:
            committed_m.append(statuses[-1].height_above_pad_m or 0.0)
        assert again.step().status.contact_forecast == statuses[-1].contact_forecast  # the same step, made twice
    forecasts = [(status.height_above_pad_m or 0.0, status.contact_forecast) for status in statuses[:-1]]
    known = [(height_m, one) for height_m, one in forecasts if one is not None]
    assert len({id(one) for _, one in known}) >= len(forecasts) // 5
    for _, one in known:
        assert one.s1 + one.unsafe + one.broken_off == pytest.approx(1.0, abs=1e-6)
        assert one.s2 <= one.s1 + 1e-9
    assert next(one for height_m, one in known if height_m < 0.1).s1 > 0.98
    # What it waits for above the commit height is no reason to turn back below.
    assert 0.0 < max(committed_m) < flight.config.descent.commit_height_m
