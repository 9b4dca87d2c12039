"""The drone's true motion as the other programs of a simulation get it."""

from link.frames import conjugate, rotate
from link.messages import BodyTruth, RotorTruth
from sim_autopilot.core.data import PlantState


def drone_truth(state: PlantState) -> BodyTruth:
    """Return the drone's pose in W and its velocities in B."""
    w, x, y, z = state.orientation_wxyz.tolist()
    px, py, pz = state.position_enu_m.tolist()
    p, q, r = state.angular_velocity_flu_rad_s.tolist()
    return BodyTruth(
        t_ns=state.t_ns,
        position_enu_m=(px, py, pz),
        orientation_wxyz=(w, x, y, z),
        velocity_flu_m_s=rotate(conjugate((w, x, y, z)), state.velocity_enu_m_s.tolist()),
        angular_velocity_flu_rad_s=(p, q, r),
    )


def rotor_truth(state: PlantState) -> RotorTruth:
    """Return the rotor speeds."""
    a, b, c, d = state.rotor_speed_rad_s.tolist()
    return RotorTruth(t_ns=state.t_ns, speed_rad_s=(a, b, c, d))
