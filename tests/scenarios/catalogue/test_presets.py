"""The sensor presets against the benchmark's table, by what their samples are like over many seeds."""

import numpy as np
import pytest

from link.messages import PadSighting, VehicleImu
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import SensorsConfig
from tests.scenarios.simulation.test_sensors import ON_ROOF, drone_at, of_kind, sampled

NOMINAL, DEGRADED, NO_HEADING = (
    load_scenario(f"straight_5+sensors={name}").sensors for name in ("nominal", "degraded", "degraded_no_heading")
)


def sightings(config: SensorsConfig, seed: int, duration_s: float, height_m: float = 4.0) -> list[PadSighting]:
    samples = sampled(
        config,
        duration_s,
        seed=seed,
        mounting=ON_ROOF,
        drone=lambda t_ns: drone_at(t_ns, (12.0, -7.0, 2.0 + height_m)),
    )
    return of_kind(samples, PadSighting)


@pytest.mark.slow
def test_degraded_pattern_is_hidden_for_10_to_40_percent_of_the_time() -> None:
    # 10 Hz over 30 s, less the 0.15 s under way; dropouts of 0.5 s leave each run's share off by some 0.05
    hidden = np.array([1.0 - len(sightings(DEGRADED, seed, 30.0)) / 298.5 for seed in range(24)])
    assert hidden.mean() == pytest.approx(0.25, abs=0.06)
    assert 0.0 <= hidden.min() < 0.20
    assert 0.30 < hidden.max() < 0.55


@pytest.mark.parametrize(("height_m", "seen"), [(0.48, False), (0.52, True)])
def test_degraded_pattern_is_not_seen_from_below_half_a_metre(height_m: float, *, seen: bool) -> None:
    assert bool(sightings(DEGRADED, 1, 5.0, height_m)) is seen


def test_clocks_are_off_by_up_to_what_the_table_says() -> None:
    def first_stamps_s(config: SensorsConfig) -> np.ndarray:
        runs = [sampled(config, 0.4, seed=seed) for seed in range(150)]
        # the first fix or imu sample leaves when its delay is over; what remains is the clock
        imus = [next((left_ns, one) for left_ns, one in run if isinstance(one, VehicleImu)) for run in runs]
        return np.array([(one.t_ns - left_ns) * 1e-9 for left_ns, one in imus])

    for config, most_s in ((NOMINAL, 0.002), (DEGRADED, 0.1)):
        offsets_s = first_stamps_s(config)
        assert np.abs(offsets_s).max() <= most_s + 1e-4
        assert offsets_s.std() == pytest.approx(most_s / np.sqrt(3.0), rel=0.15)  # an even distribution
    assert DEGRADED.clock.drift_max == pytest.approx(50e-6)


def test_degraded_vehicle_without_heading_tells_none() -> None:
    assert of_kind(sampled(DEGRADED, 2.0), VehicleImu)
    assert of_kind(sampled(NO_HEADING, 2.0), VehicleImu) == []
