"""How fast the ways of a sortie lead: never faster than the plan that follows them, or it is not flown straight."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.data import FlightLimits
from companion.landing.sortie.aims import return_aim, station_aim
from companion.landing.sortie.over_vehicle import SPEED_SHARE
from companion.planning.guidance import ReferenceState
from companion.sortie.memory import SortieMemory, Way
from link.messages import Station
from link.records import replace
from tests.companion.facts import CONFIG, GEAR_M, PAD_ENU_M, pad_at, reference_at, situation

PAD = pad_at((4.6, 1.9, 0.0))  # 4.98 m/s
LIMITS = FlightLimits(
    speed_max_m_s=6.0,  # what is advised for a vehicle at 5 m/s
    climb_max_m_s=2.5,
    descent_max_m_s=1.5,
    acceleration_max_m_s2=5.0,
    vertical_acceleration_max_m_s2=2.0,
    jerk_max_m_s3=8.0,
    vertical_jerk_max_m_s3=8.0,
)
places = st.tuples(st.floats(-200.0, 200.0), st.floats(-200.0, 200.0), st.floats(2.0, 40.0))


def at(offset_m: tuple[float, float, float]) -> ReferenceState:
    return replace(reference_at(0.0), position_enu_m=PAD_ENU_M + np.array(offset_m) + np.array([0.0, 0.0, GEAR_M]))


@given(offset_m=places)
def test_way_home_is_no_faster_than_the_drone(offset_m: tuple[float, float, float]) -> None:
    target = return_aim(PAD, at(offset_m), situation(pad=PAD), CONFIG, limits=LIMITS).target
    speeds_m_s = np.hypot(*target.velocity_enu_m_s[:, :2].T)
    assert speeds_m_s.max() <= SPEED_SHARE * LIMITS.speed_max_m_s + 1e-6
    assert -LIMITS.descent_max_m_s - 1e-6 <= target.velocity_enu_m_s[:, 2].min()
    assert target.velocity_enu_m_s[:, 2].max() <= LIMITS.climb_max_m_s + 1e-6


def test_way_ahead_to_a_station_is_no_faster_than_the_plan() -> None:
    station = Station(offset_m=(20.0, 0.0, 6.0))
    here = np.array([-9.0, -4.0, 6.0])
    way = Way(station=station, frame=station.frame, end_m=np.array(station.offset_m), place_m=here, at_ns=0)
    sortie = SortieMemory(is_out=True, station=station, way=way)
    limits = replace(LIMITS, speed_max_m_s=1.15 * 4.98)  # that may be carried on
    target = station_aim(sortie, PAD, situation(pad=PAD), limits, CONFIG).target
    speed_m_s = float(np.hypot(*target.velocity_enu_m_s[0, :2]))
    assert 4.98 < speed_m_s == pytest.approx(SPEED_SHARE * limits.speed_max_m_s, abs=0.01)
