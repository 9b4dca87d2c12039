"""The quadrotor's constants: "+" layout, rotors 1 and 2 on the body x axis, 3 and 4 on y.

Source: Ghribi, Polytechnique Montréal, 2022, Table 1 and eq. 5; the coefficients are of its reference simulation.
"""

from dataclasses import dataclass
from math import radians, tan

GRAVITY_M_S2 = 9.81


@dataclass(frozen=True, slots=True, kw_only=True)
class Airframe:
    """A "+" quadrotor; the defaults are the report's, without lag, limits or drag.

    Attributes:
        mass_kg: of everything that flies.
        inertia_kg_m2: principal moments about x, y, z of B.
        arm_m: from the centre of mass to each rotor.
        thrust_coefficient_n_s2: thrust over rotor speed squared.
        torque_coefficient_n_m_s2: drag torque over rotor speed squared.
        rotor_radius_m: of one propeller (10 inches), for the ground effect and the reach of the blades.
        motor_time_constant_s: first-order lag of the rotor speed; None is no lag.
        thrust_to_weight: of all rotors at full speed; None is no limit, on either side.
        drag_n_s_m: linear drag on airspeed, equal in all directions.
        drag_n_s2_m2: quadratic drag on airspeed, equal in all directions.
    """

    mass_kg: float = 1.507
    inertia_kg_m2: tuple[float, float, float] = (0.035, 0.046, 0.0977)
    arm_m: float = 0.215
    thrust_coefficient_n_s2: float = 6.7e-6
    torque_coefficient_n_m_s2: float = 3.12e-7
    rotor_radius_m: float = 0.127
    motor_time_constant_s: float | None = None
    thrust_to_weight: float | None = None
    drag_n_s_m: float = 0.0
    drag_n_s2_m2: float = 0.0

    @property
    def weight_n(self) -> float:
        """The thrust that hovers."""
        return self.mass_kg * GRAVITY_M_S2

    @property
    def hover_speed_rad_s(self) -> float:
        """The rotor speed that hovers."""
        return float((self.weight_n / (4.0 * self.thrust_coefficient_n_s2)) ** 0.5)

    @property
    def takes_wrench_directly(self) -> bool:
        """Whether thrust and torques act at once and unbounded, as in the report."""
        return self.motor_time_constant_s is None and self.thrust_to_weight is None


REPORT_AIRFRAME = Airframe()
"""The report's: its plant input is [T, L, M, N] itself."""

BENCHMARK_AIRFRAME = Airframe(motor_time_constant_s=0.05, thrust_to_weight=2.0, drag_n_s_m=0.25)
"""The report's body with the motors and the drag that its own simulation lacked."""

_CEILING_M_S = 10.28
_MOMENTUM_DRAG_PER_S = 0.248
"""Of the rotors' air, linear in speed: mdrag_coef 0.2 times the root of the hover thrust (3 kg), 1.225 kg/m3 and
disc_area 0.385 m2, over the mass; ArduPilot's SIM_Frame."""
ARDUCOPTER_AIRFRAME = Airframe(
    motor_time_constant_s=0.05,
    thrust_to_weight=2.6,
    drag_n_s_m=_MOMENTUM_DRAG_PER_S * REPORT_AIRFRAME.mass_kg,
    drag_n_s2_m2=(GRAVITY_M_S2 * tan(radians(30.0)) - _MOMENTUM_DRAG_PER_S * _CEILING_M_S)
    * REPORT_AIRFRAME.mass_kg
    / _CEILING_M_S**2,
)
"""The report's body as strong and as draggy as ArduCopter's own simulated quadrotor: it hovers at 0.387 of its thrust
(the MOT_THST_HOVER that it learns), and leaning 30 degrees it flies 10.28 m/s, as measured; the drag is in part the
rotors', in part quadratic."""

_SIH_DRAG_PER_S = 0.3
PX4_AIRFRAME = Airframe(
    motor_time_constant_s=0.05, thrust_to_weight=2.04, drag_n_s_m=_SIH_DRAG_PER_S * REPORT_AIRFRAME.mass_kg
)
"""The report's body as strong and as draggy for its mass as PX4's own simulated quadrotor: SIH_T_TAU 0.05 s, four
rotors of SIH_T_MAX 5 N for SIH_MASS 1 kg, SIH_KDV 0.3 N s/m (a realistic one: its default of 1 allows 9 m/s)."""
