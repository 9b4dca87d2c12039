"""Guidance only: the pad's place for an autopilot that flies its own precision landing; pure."""

from companion.autopilots.landing_target import landing_target
from companion.autopilots.own_reports import carry
from companion.config.autopilot import Guide
from companion.config.companion import CompanionConfig
from companion.landing.step_data import StepInputs, StepOutputs
from companion.vehicle.pad_reach import is_unseen
from link.mavlink.dialect import Message


def guiding_message(outputs: StepOutputs, inputs: StepInputs, config: CompanionConfig, local_ns: int) -> Message | None:
    """Return the LANDING_TARGET of a step, None while nothing is guided or the pad is not known well enough.

    An autopilot that hears none for some seconds does what its own parameters say of a lost target.

    Args:
        outputs: of the step.
        inputs: likewise.
        config: all numbers.
        local_ns: now, on the companion's own clock.
    """
    if config.autopilot.guide is not Guide.PRECLAND:
        return None
    pad, own, driver, fix_age_s = outputs.pad, inputs.own, inputs.driver, outputs.status.fix_age_s
    if pad is None or own is None or driver is None or pad.unplaced is not None or is_unseen(pad, config):
        return None
    age_s = (inputs.t_ns - own.t_ns) * 1e-9
    if fix_age_s is None or fix_age_s > config.abort.fix_age_max_s or age_s > config.abort.own_age_max_s:
        return None
    x, y, z = pad.position_enu_m[0].tolist()
    return landing_target(
        (x, y, z),
        pad.yaw_rad,
        carry(own, inputs.t_ns),
        in_body_axes=driver.takes_target_in_body_axes,
        local_ns=local_ns,
    )
