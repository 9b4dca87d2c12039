"""What the autopilot is ordered in each phase: its mode, its motors, its take-off; pure."""

from companion.autopilots.driver import AutopilotCommand, Desire
from companion.autopilots.messages import is_arming
from companion.config.companion import CompanionConfig
from companion.core.reasons import Reason
from companion.landing.decisions.conditions import HELD_UP, holds, is_low_above_pad
from companion.landing.decisions.contact import may_force_motors_off
from companion.landing.decisions.contact_signs import signs_of
from companion.landing.decisions.taken_control import is_held_on_ground
from companion.landing.sortie.over_vehicle import shall_motors_turn
from companion.landing.state.memory import StepMemory
from companion.landing.state.step_data import StepInputs
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from link.records import replace

_NEAR_PAD = frozenset({Phase.DESCEND, Phase.ABORT, Phase.LIFT_OFF})
_DISARM_MAX_S = 1.0  # it takes 0.6 s where the plain one is refused; the companion waits for longer before it ends


def drive(
    memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig
) -> tuple[StepMemory, tuple[AutopilotCommand, ...]]:
    """Return the memory and the commands that bring the autopilot to what the phase needs."""
    if inputs.driver is None:
        return memory, ()
    driver_memory = memory.control.driver
    for command, result in inputs.acknowledgements:
        driver_memory = inputs.driver.acknowledged(driver_memory, command, result)
    hands_over = inputs.leaving and not _must_finish(memory, situation, config)
    desire = _last_desire(memory, situation) if hands_over else _desire(memory, situation, config)
    driver_memory, commands = inputs.driver.act(driver_memory, inputs.autopilot, desire, inputs.monotonic_ns)
    if driver_memory is not memory.control.driver:
        memory = replace(memory, control=replace(memory.control, driver=driver_memory))
    return memory, commands


def _must_finish(memory: StepMemory, situation: Situation, config: CompanionConfig) -> bool:
    """Return whether the companion flies on although it is to end: what it does now is soon over.

    An autopilot that hovers by itself would leave the pad on which the motors are being switched off. Low above the pad
    it would sink onto it as it brakes, and the pad that drives on would throw the drone off.
    """
    if memory.progress.phase is Phase.TOUCHDOWN:
        return _in_phase_s(memory, situation) < _DISARM_MAX_S
    return memory.progress.phase in _NEAR_PAD and is_low_above_pad(situation, config)


def _last_desire(memory: StepMemory, situation: Situation) -> Desire:
    """Return what is wanted of the autopilot before the companion ends: a hover, but no motors left on on the ground.

    The disarm is a plain one, which an autopilot that has left the ground refuses.
    """
    is_on_ground = memory.progress.phase is Phase.TAKEOFF and situation.autopilot.landed is True
    is_refused = memory.control.driver.disarm_refusals > 0
    return Desire(armed=False) if is_on_ground and not is_refused else Desire(release=True)


def _in_phase_s(memory: StepMemory, situation: Situation) -> float:
    return (situation.monotonic_ns - memory.progress.since_ns) * 1e-9


def _desire(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Desire:
    progress = memory.progress
    match progress.phase:
        case Phase.TAKEOFF:
            return Desire(control=True, armed=True, takeoff_height_m=config.takeoff.waiting_height_m)
        case Phase.ON_DECK:
            return Desire(control=True, armed=shall_motors_turn(memory.sortie, situation, config.sortie.launch))
        case Phase.LIFT_OFF:
            return Desire(takeoff_height_m=config.sortie.launch.clear_height_m, leaves_deck=True)
        case Phase.TOUCHDOWN:
            # Without accelerations in its setpoints an autopilot is not pressed down so hard that it would fall.
            held_up = holds(HELD_UP, progress.held, situation, config) and not config.setpoints.position_only
            evidence = may_force_motors_off(
                signs_of(situation, config.touchdown),
                _in_phase_s(memory, situation),
                config,
                stopped_and_held=progress.stopped_by_pad and held_up,
            )
            return Desire(armed=False, force_disarm=evidence)
        case Phase.HOLD | Phase.PILOT if _turns_for_nobody(memory, situation):
            return Desire(armed=False)
        case _:
            return Desire()  # control that was had and is lost is not taken back


def _turns_for_nobody(memory: StepMemory, situation: Situation) -> bool:
    """Return whether motors turn on the ground after a take-off that was broken off, or ordered by who gave way.

    The disarm is a plain one, and ends with the mode: a person who flies meanwhile is left alone.
    """
    if is_held_on_ground(memory.progress.phase, memory.control, situation):
        return True
    if memory.progress.cause.reason is not Reason.DRONE_TAKEN:
        return False
    driver, view = memory.control.driver, situation.autopilot
    is_ordered = driver.arm_asked or driver.disarm_asked or is_arming(driver, situation.monotonic_ns)
    return is_ordered and view.landed is True and view.in_control and driver.disarm_refusals == 0
