"""Ranges among the measurements of a step: each once, in time, and of a vehicle that is known."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import pytest

from companion.core.data import Measurement, Quantity, RangeReading
from link.records import replace
from tests.companion.world import PAD_HEIGHT_M, STEP_NS, Flight, KnownVehicle

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


def _sees(flight: Flight, t_ns: int) -> None:
    range_down = RangeReading(t_ns=t_ns, distance_m=1.0, own=replace(flight.own, t_ns=t_ns))
    flight.view = replace(flight.view, range_down=range_down)


def test_each_range_is_fused_once() -> None:
    flight, ranges_ns = _flight()
    flight.run(0.2)
    told_ns = []
    for _ in range(3):
        _sees(flight, flight.t_ns - 5_000_000)
        told_ns.append(flight.t_ns - 5_000_000)
        flight.run(0.1)
    assert ranges_ns == told_ns


@pytest.mark.parametrize("ahead_ns", [_HOUR_NS, -_HOUR_NS])
def test_range_of_another_hour_is_not_fused(ahead_ns: int) -> None:
    flight, ranges_ns = _flight()
    flight.run(0.2)
    _sees(flight, flight.t_ns + ahead_ns)
    flight.run(0.5)
    assert ranges_ns == []
    _sees(flight, flight.t_ns)
    flight.step()
    assert ranges_ns == [flight.t_ns - STEP_NS]


def test_range_before_the_vehicle_is_known_is_not_fused() -> None:
    flight, ranges_ns = _flight()
    flight.sends_fixes = False
    _sees(flight, flight.t_ns)
    flight.run(0.1)
    assert ranges_ns == []
