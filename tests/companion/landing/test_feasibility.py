"""What cannot be landed on is refused with its numbers, once, and not chased."""

import pytest

from companion.config.companion import CompanionConfig
from companion.landing.aborts import ABORTS
from companion.landing.feasibility import OBSTACLES
from companion.situation.phases import Phase
from link.messages import Command
from link.records import replace
from tests.companion.world import CONFIG, PAD_HEIGHT_M, START_NS, Flight, KnownVehicle

FAST = KnownVehicle((-60.0, 0.4, PAD_HEIGHT_M), (14.2, 0.0, 0.0))


def limited(**limits: float) -> CompanionConfig:
    return CONFIG.model_copy(update={"limits": CONFIG.limits.model_copy(update=limits)})


def test_start_is_refused_with_the_numbers() -> None:
    flight = Flight(vehicle=FAST, config=limited(speed_max_m_s=12.0))
    flight.run(CONFIG.chase.driving_hold_s + 0.1)
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert not reply.accepted
    assert reply.reason.startswith("vehicle at 14.2 m/s needs 16.3 m/s, the limit is 12.0: raise limits.speed_max_m_s")
    assert flight.commands == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("config", "battery_share", "told"),
    [
        (limited(speed_max_m_s=12.0), None, "needs 16.3 m/s"),
        (limited(range_max_m=100.0), None, "goes 213 m in 15 s, limits.range_max_m is 100"),
        (CONFIG, 0.15, "battery at 15 %"),
    ],
)
def test_vehicle_out_of_reach_is_told_once_and_let_go(
    config: CompanionConfig, battery_share: float | None, told: str
) -> None:
    flight = Flight(vehicle=replace(FAST, start_enu_m=(-200.0, 0.4, PAD_HEIGHT_M)), config=config)
    flight.sends_fixes = False
    flight.start_and_reach(Phase.WAITING)
    flight.sends_fixes = True
    flight.view = replace(flight.view, battery_share=battery_share)
    outputs = flight.run(16.0)
    assert flight.phase is Phase.WAITING
    assert Phase.CHASE not in flight.history
    assert len([one.text for one in outputs if one.text is not None and told in one.text]) == 1
    assert told in outputs[100].status.reason


def test_vehicle_that_slows_down_is_chased_after_all() -> None:
    flight = Flight(vehicle=FAST, config=limited(speed_max_m_s=12.0))
    flight.sends_fixes = False
    flight.start_and_reach(Phase.WAITING)
    flight.sends_fixes = True
    flight.run(1.0)
    x, y, _ = flight.own.position_enu_m
    flight.vehicle = KnownVehicle((x - 8.0 - 4.0 * (flight.t_ns - START_NS) * 1e-9, y, PAD_HEIGHT_M), (4.0, 0.0, 0.0))
    flight.run_until(Phase.CHASE, limit_s=5.0)


def test_what_makes_a_landing_impossible_is_no_reason_to_break_one_off() -> None:
    # Held under one name, it would begin the climb of an abort anew in every step.
    assert not {obstacle.reason for obstacle in OBSTACLES} & {test.reason for test in ABORTS}
