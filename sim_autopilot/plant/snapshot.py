"""The drone as its autopilot believes it to be at one instant, as plain numbers, so that arrays are unpacked once."""

from math import hypot

from msgspec import Struct

from link.frames.rotations import conjugate, rotate, yaw_of
from link.messages import BodyTruth, Quaternion, RotorTruth, Vector3
from sim_autopilot.core.data import Array, PlantState
from sim_autopilot.physics.airframe import Airframe
from sim_autopilot.plant.own_state import NO_ERROR


class Snapshot(Struct, frozen=True, kw_only=True):
    """The drone at `t_ns`, `boot_ns` after the autopilot's start; W is ENU about the datum, B is FLU.

    `thrust_share` is the rotors' thrust over the weight.
    """

    t_ns: int
    boot_ns: int
    position_enu_m: Vector3
    velocity_enu_m_s: Vector3
    orientation_wxyz: Quaternion
    angular_velocity_flu_rad_s: Vector3
    specific_force_flu_m_s2: Vector3
    yaw_rad: float
    thrust_share: float

    @property
    def speed_m_s(self) -> float:
        """Horizontal speed over ground."""
        return hypot(self.velocity_enu_m_s[0], self.velocity_enu_m_s[1])


def take_snapshot(state: PlantState, airframe: Airframe, boot_ns: int, own_error: Array = NO_ERROR) -> Snapshot:
    """Return `state` as plain numbers with the estimate's error (6,) in position, m, and velocity, m/s."""
    px, py, pz = (state.position_enu_m + own_error[:3]).tolist()
    vx, vy, vz = (state.velocity_enu_m_s + own_error[3:]).tolist()
    w, x, y, z = state.orientation_wxyz.tolist()
    p, q, r = state.angular_velocity_flu_rad_s.tolist()
    fx, fy, fz = state.specific_force_flu_m_s2.tolist()
    a, b, c, d = state.rotor_speed_rad_s.tolist()
    thrust_n = airframe.thrust_coefficient_n_s2 * (a * a + b * b + c * c + d * d)
    return Snapshot(
        t_ns=state.t_ns,
        boot_ns=boot_ns,
        position_enu_m=(px, py, pz),
        velocity_enu_m_s=(vx, vy, vz),
        orientation_wxyz=(w, x, y, z),
        angular_velocity_flu_rad_s=(p, q, r),
        specific_force_flu_m_s2=(fx, fy, fz),
        yaw_rad=yaw_of((w, x, y, z)),
        thrust_share=thrust_n / airframe.weight_n,
    )


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
