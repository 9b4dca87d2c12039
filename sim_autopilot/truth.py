"""The drone's true state as it is published for the score and the vehicle's sensors."""

from link.frames import conjugate, rotate
from link.messages import BodyTruth, Quaternion, RotorTruth, Vector3
from sim_autopilot.data import Array, PlantState


def drone_truth(state: PlantState) -> BodyTruth:
    """Return the pose in W and the velocities in B, as nav_msgs has them."""
    orientation = _quaternion(state.orientation_wxyz)
    return BodyTruth(
        t_ns=state.t_ns,
        position_enu_m=_vector(state.position_enu_m),
        orientation_wxyz=orientation,
        velocity_flu_m_s=rotate(conjugate(orientation), state.velocity_enu_m_s.tolist()),
        angular_velocity_flu_rad_s=_vector(state.angular_velocity_flu_rad_s),
    )


def rotor_truth(state: PlantState) -> RotorTruth:
    """Return the rotor speeds."""
    first, second, third, fourth = state.rotor_speed_rad_s.tolist()
    return RotorTruth(t_ns=state.t_ns, speed_rad_s=(first, second, third, fourth))


def _vector(array: Array) -> Vector3:
    x, y, z = array.tolist()
    return (x, y, z)


def _quaternion(array: Array) -> Quaternion:
    w, x, y, z = array.tolist()
    return (w, x, y, z)
