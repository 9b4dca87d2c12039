"""The node's times: fixes that are late, early or swapped, a UTC that is set, a computer that is held up."""

import re
from typing import cast

import numpy as np
import pytest

from companion.integrity.sightings import SightingWatch
from companion.vehicle.estimator import DelayBuffer
from link.records import replace
from tests.companion.peer import Setup
from tests.companion.runtime.setups import flying, ready
from tests.link.mavlink.fake_autopilot import S


def test_fixes_that_come_long_after_their_stamps_forbid_a_landing_and_say_by_how_much() -> None:
    setup = ready()
    for _ in range(20):
        setup.fix(late_s=1.2)
        setup.run(0.1)
    assert setup.node.outputs is not None
    status = setup.node.outputs.status
    assert status.reason_code == "STAMPS_LATE"
    assert re.match(r"vehicle.s fixes come 1\.2\d s after their stamps, abort\.fix_age_max_s is 1:", status.reason)


def test_fix_from_the_future_is_counted_and_dropped() -> None:
    setup = ready()
    setup.fix(late_s=-1.0)
    setup.run(0.1)
    assert setup.node.bad_payloads == 1
    assert setup.node.memory.vehicle.estimator is None
    setup.fix(late_s=-0.3)
    setup.run(0.1)
    assert setup.node.bad_payloads == 1
    assert setup.node.memory.vehicle.estimator is not None


@pytest.mark.slow
def test_late_and_swapped_fixes_leave_the_same_estimate() -> None:
    places = [(float(x), 0.4, 1.5) for x in range(6)]

    def fly(order: list[int]) -> np.ndarray:
        setup = ready()
        for i in order:
            setup.fix(places[i], late_s=1.0 - 0.1 * i)
        setup.run(0.05)
        memory = cast("DelayBuffer[object]", setup.node.memory.vehicle.estimator)
        return np.array([entry.measurement.t_ns for entry in memory.entries])

    np.testing.assert_array_equal(fly([0, 1, 2, 3, 4, 5]), fly([3, 0, 5, 1, 4, 2]))


@pytest.mark.slow
@pytest.mark.parametrize("set_by_s", [-37.0, -0.9, 0.7, 90.0])
def test_flight_goes_on_evenly_when_utc_is_set(set_by_s: float) -> None:
    setup = flying()
    setup.run(3.0)
    phase, since_s, before = setup.node.phase, in_phase_s(setup), len(setup.autopilot.setpoints())
    setup.autopilot.utc_set_by_ns = round(set_by_s * S)
    setup.run(4.0)
    assert abs(setup.node.autopilot.session.clock.local_to_utc_ns(setup.t_ns) - setup.utc_ns) < S
    assert setup.node.outputs is not None
    assert abs(setup.node.outputs.status.stamp_ns - setup.utc_ns) < S
    assert setup.node.outputs.status.relative_position_enu_m is None
    assert setup.node.phase is phase
    assert in_phase_s(setup) == pytest.approx(since_s + 4.0, abs=0.3)
    assert len(setup.autopilot.setpoints()) - before > 190


@pytest.mark.parametrize("set_by_s", [-0.1, 0.1])
def test_time_of_the_flight_is_not_moved_by_a_small_correction_of_utc(set_by_s: float) -> None:
    setup = flying()
    setup.run(9.0)
    assert setup.node.inputs is not None
    ahead_ns, set_ns = setup.node.inputs.monotonic_ns - setup.t_ns, setup.node.autopilot.utc_set_ns
    setup.autopilot.utc_set_by_ns = round(set_by_s * S)
    setup.run(5.0)
    assert setup.node.autopilot.utc_set_ns - set_ns == pytest.approx(set_by_s * S, abs=0.01 * S)
    assert setup.node.inputs.t_ns == pytest.approx(setup.utc_ns, abs=0.03 * S)
    assert setup.node.inputs.monotonic_ns - setup.t_ns == pytest.approx(ahead_ns, abs=0.03 * S)


@pytest.mark.parametrize(("set_by_s", "goes_on"), [(0.1, True), (0.7, False)])
def test_pad_that_was_seen_stays_where_it_is_through_a_small_correction_of_utc(
    set_by_s: float, *, goes_on: bool
) -> None:
    setup = flying()
    setup.run(9.0)
    vehicle = setup.node.memory.vehicle
    setup.node.memory = replace(setup.node.memory, vehicle=replace(vehicle, sightings=SightingWatch(is_confirmed=True)))
    setup.autopilot.utc_set_by_ns = round(set_by_s * S)
    setup.run(5.0)
    assert setup.node.memory.vehicle.sightings.is_confirmed is goes_on


def in_phase_s(setup: Setup) -> float:
    assert setup.node.inputs is not None
    return (setup.node.inputs.monotonic_ns - setup.node.memory.progress.since_ns) * 1e-9


@pytest.mark.parametrize("held_up_s", [0.6, 2.0])
def test_what_waited_while_the_computer_was_held_up_is_not_from_the_future(held_up_s: float) -> None:
    setup = ready()
    refused = setup.node.bad_payloads
    setup.t_ns += round(held_up_s * S)
    setup.fix((1.0, 2.0, 1.5))
    setup.node.poll(setup.t_ns)
    assert setup.node.inputs is not None
    assert [one.t_ns for one in setup.node.inputs.vehicle.measurements] == [setup.utc_ns]
    assert (setup.node.bad_payloads, setup.node.inputs.vehicle.fix_ahead_s) == (refused, None)


def test_fixes_from_far_in_the_future_forbid_a_landing_and_say_by_how_much() -> None:
    setup = ready()
    for _ in range(20):
        setup.fix(late_s=-4.4)
        setup.run(0.1)
    assert setup.node.outputs is not None
    status = setup.node.outputs.status
    assert status.reason_code == "STAMPS_AHEAD"
    found = re.search(r"come (\S+) s before", status.reason)
    assert found is not None
    assert float(found[1]) == pytest.approx(4.4, abs=0.05)  # taken by the next step
    assert setup.node.vehicle.refused_lately().startswith("fix: 20 refused, come 4.4 s before their stamps")
