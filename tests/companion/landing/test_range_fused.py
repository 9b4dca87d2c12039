"""Ranges among the measurements of a step: each once, in time, and of a vehicle that is known."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import pytest

from companion.core.data import Measurement, Quantity, RangeReading
from link.records import replace
from tests.companion.world import PAD_HEIGHT_M, Flight, KnownVehicle

_HOUR_NS = 3_600_000_000_000


@dataclass(frozen=True, slots=True)
class _Watched(KnownVehicle):
    """Notes the ranges that it is given."""

    ranges_ns: list[int] = field(default_factory=list)

    def fuse(self, memory: int | None, measurements: Sequence[Measurement]) -> int:
        self.ranges_ns.extend(one.t_ns for one in measurements if one.quantity is Quantity.SURFACE)
        return KnownVehicle.fuse(self, memory, measurements)


def _flight() -> tuple[Flight, list[int]]:
    vehicle = _Watched((-20.0, 0.4, PAD_HEIGHT_M), (4.0, 0.0, 0.0))
    return Flight(vehicle=vehicle), vehicle.ranges_ns


def _sees(flight: Flight, t_ns: int, *, distance_m: float = 1.0, risen_m: float = 0.0) -> None:
    x, y, z = flight.own.position_enu_m
    own = replace(flight.own, t_ns=t_ns, position_enu_m=(x, y, z + risen_m))
    flight.view = replace(flight.view, range_down=RangeReading(t_ns=t_ns, distance_m=distance_m, own=own))


def _look(flight: Flight, times: int) -> list[int]:
    """Let it see the same surface so many times, and return when that was."""
    told_ns = []
    for _ in range(times):
        told_ns.append(flight.t_ns - 5_000_000)
        _sees(flight, told_ns[-1])
        flight.run(0.1)
    return told_ns


def test_each_range_is_fused_once_from_the_fifth_on_that_agrees() -> None:
    flight, ranges_ns = _flight()
    flight.run(0.2)
    told_ns = _look(flight, 7)
    assert ranges_ns == told_ns[4:]


@pytest.mark.parametrize("ahead_ns", [_HOUR_NS, -_HOUR_NS])
def test_range_of_another_hour_is_not_fused(ahead_ns: int) -> None:
    flight, ranges_ns = _flight()
    flight.run(0.2)
    _sees(flight, flight.t_ns + ahead_ns)
    flight.run(0.5)
    assert ranges_ns == []
    told_ns = _look(flight, 5)
    assert ranges_ns == told_ns[4:]


def test_range_before_the_vehicle_is_known_is_not_fused() -> None:
    flight, ranges_ns = _flight()
    flight.sends_fixes = False
    _look(flight, 7)
    assert ranges_ns == []


def test_range_finder_that_says_the_same_while_the_drone_rises_is_not_believed_until_it_measures_again() -> None:
    flight, ranges_ns = _flight()
    flight.run(0.2)
    told_ns = _look(flight, 5)
    for distance_m, risen_m in ((1.0, 0.04), (1.0, 0.08), (1.0, 0.6), (1.02, 0.02)):
        told_ns.append(flight.t_ns - 5_000_000)
        _sees(flight, told_ns[-1], distance_m=distance_m, risen_m=risen_m)
        flight.run(0.1)
    assert ranges_ns == [told_ns[4], told_ns[5], told_ns[8]]
