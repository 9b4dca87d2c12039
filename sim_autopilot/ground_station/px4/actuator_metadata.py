"""PX4's actuators, for clients that read from its component metadata which outputs drive which motors.

Source of the format: https://mavlink.io/en/services/component_information.html, actuators. The four motors of the
simulated quadrotor, and the sixteen outputs of its simulation.
"""

ACTUATORS_PATH = "etc/extras/actuators.json.xz"
_MOTORS, _OUTPUTS = 4, 16
_FIRST_MOTOR, _LAST_MOTOR = 101, 112
"""The numbers of the functions that are motors; 0 is none."""


def actuators_description() -> dict[str, object]:
    """Return which functions there are, which outputs, and what the mixer drives."""
    motors = {str(_FIRST_MOTOR + place): {"label": f"Motor {place + 1}"} for place in range(_MOTORS)}
    channels = [{"label": f"Channel {number}", "param-index": number} for number in range(1, _OUTPUTS + 1)]
    function = {"label": "Function", "name": "PWM_MAIN_FUNC${i}", "function": "function"}
    outputs = {"label": "SIM", "subgroups": [{"channels": channels, "per-channel-parameters": [function]}]}
    motor = {
        "function-min": _FIRST_MOTOR,
        "function-max": _LAST_MOTOR,
        "label-index-offset": 1,
        "values": {"min": 0, "max": 1, "default-is-nan": True},
    }
    group = {"group-label": "Motors", "count": _MOTORS, "actuator-type": "motor", "required": True}
    mixer = {"actuator-types": {"motor": motor}, "config": [{"title": "Multirotor", "actuators": [group]}]}
    return {
        "version": 1,
        "functions_v1": {"0": {"label": "Disabled"}, **motors},
        "outputs_v1": [outputs],
        "mixer_v1": mixer,
    }
