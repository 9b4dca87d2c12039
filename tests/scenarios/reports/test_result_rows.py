"""What a run's page tells of its result."""

import math

import pytest

from scenarios.recordings.result import units_of
from scenarios.reports.result_rows import result_rows


def told(**result: object) -> dict[str, str]:
    """Return the values that are shown, by name."""
    return {name: value for name, value, _ in result_rows(result)}


def test_angles_are_told_in_degrees_and_other_values_in_their_unit() -> None:
    shown = told(tilt_over_trim_rad=math.radians(7.5), sink_rate_m_s=0.4, vehicle_curvature_per_m=0.02, on_pad=True)
    assert shown == {
        "tilt over trim": "7.500 degrees",
        "sink rate": "0.400 m/s",
        "vehicle curvature": "0.020 1/m",
        "on pad": "yes",
    }


@pytest.mark.parametrize(
    ("mean", "shown"),
    # chi-square quantiles of 6 degrees of freedom: 1.237 and 14.449
    [(1.2, "1.20 below (1.24 to 14.45)"), (6.0, "6.00 (1.24 to 14.45)"), (14.5, "14.50 above (1.24 to 14.45)")],
)
def test_nees_out_of_its_band_is_marked(mean: float, shown: str) -> None:
    assert told(nees_mean=mean)["NEES"] == shown


def test_limits_of_the_tiers_stand_beside_what_they_bound() -> None:
    ((_, _, meaning),) = result_rows({"tilt_over_trim_rad": 0.1})
    assert meaning.endswith("at most: S2 10.000 degrees, S1 15.000 degrees")


def test_unit_of_a_name_is_that_of_its_longest_ending() -> None:
    assert units_of(["a_m_s", "b_m", "c_per_m", "d_m_s2", "tier"]) == {
        "a_m_s": "m/s",
        "b_m": "m",
        "c_per_m": "1/m",
        "d_m_s2": "m/s^2",
    }
