"""From the virtual model to the setpoint that the autopilot is sent; pure."""

import math

from companion.autopilots.velocity_bias import as_seen_with
from companion.config.companion import CompanionConfig
from companion.core.data import Setpoint
from companion.core.reasons import Reason
from companion.landing.memory import StepMemory
from companion.landing.step_data import StepInputs
from companion.landing.virtual_model import extrapolate, free_place, press_down, setpoint_at, state_in_plan
from companion.planning.guidance import PlanResult
from companion.situation.phases import Phase

# A chase keeps its place: through an outage the drone then stops where it was last sent.
_FREE_PLACE_PHASES = (Phase.ALIGN, Phase.DESCEND, Phase.TOUCHDOWN)


def setpoint(
    memory: StepMemory, inputs: StepInputs, config: CompanionConfig, plan: PlanResult | None = None
) -> Setpoint | None:
    """Return what the autopilot is to follow now, None while nothing is flown.

    Args:
        memory: after this step's plan.
        inputs: of this step.
        config: all numbers.
        plan: of this step, None when there was nothing to plan.
    """
    model = memory.model
    if model.reference is None or memory.control.driver.climbs_by_itself:
        return None
    lead_s = config.setpoint_lead_s
    if lead_s is None:
        lead_s = 0.0 if inputs.response is None else inputs.response.cascade.lead_s
    ahead_s = inputs.link_delay_s + lead_s
    if plan is None or (inputs.driver is not None and inputs.driver.carries_setpoints_on):
        reference = extrapolate(model.reference, (inputs.monotonic_ns - model.reference_ns) * 1e-9 + ahead_s)
    else:
        reference = state_in_plan(plan.trajectory, ahead_s)
    press_m_s2 = _press_m_s2(memory, config)
    if press_m_s2 is not None:
        reference = press_down(reference, press_m_s2, ahead_s)
    wanted = setpoint_at(
        reference,
        inputs.t_ns + round(ahead_s * 1e9),
        model.yaw_setpoint_rad,
        position_only=config.position_only,
    )
    if has_free_place(memory, inputs, config):
        wanted = free_place(wanted, model.tracking.behind_enu_m, config.place_gain_hz)
    return wanted if inputs.own is None else as_seen_with(wanted, inputs.own.velocity_bias_enu_m_s)


def has_free_place(memory: StepMemory, inputs: StepInputs, config: CompanionConfig) -> bool:
    """Return whether the link's jitter would move the place that is asked for too far for a landing.

    A setpoint is held as it came, so one that comes late by so much asks for a place that the vehicle has left.
    """
    reference, driver = memory.model.reference, inputs.driver
    if memory.progress.phase not in _FREE_PLACE_PHASES or reference is None or config.position_only:
        return False
    if driver is None or not driver.holds_height_alone:
        return False
    speed_m_s = math.hypot(*reference.velocity_enu_m_s[:2].tolist())
    return speed_m_s * inputs.link_delay_std_s > config.place_jitter_max_m


def _press_m_s2(memory: StepMemory, config: CompanionConfig) -> float | None:
    """Return the downward acceleration with which a drone is pressed on what it touches, None for one that flies."""
    if memory.progress.phase is Phase.TOUCHDOWN:
        return config.touchdown.press_acceleration_m_s2
    held = memory.progress.held
    touches = Reason.CONTACT in held or Reason.DISPUTED_CONTACT in held
    return config.touchdown.try_acceleration_m_s2 if touches else None
