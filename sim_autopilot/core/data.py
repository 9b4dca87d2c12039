"""What the simulated autopilot's steps hand to each other: SI units, radians, world ENU (W), body FLU (B).

Arrays are float64 and are never written in place. Quaternions are Hamilton, order wxyz, w >= 0.
"""

from enum import Enum
from math import inf

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Surface(Enum):
    """What the drone touches."""

    NONE = 0
    GROUND = 1
    DECK = 2  # the vehicle's roof, pad included
    SIDE = 3  # the vehicle's flank


class PlantState(Struct, frozen=True, kw_only=True, eq=False):
    """The drone's body at `t_ns`.

    Attributes:
        position_enu_m: (3,) centre of mass.
        orientation_wxyz: (4,) q_WB.
        velocity_enu_m_s: (3,).
        angular_velocity_flu_rad_s: (3,) w_WB in B.
        rotor_speed_rad_s: (4,).
        specific_force_flu_m_s2: (3,) what an accelerometer at the centre of mass feels.
        surface: what it touched during the last step.
    """

    t_ns: int
    position_enu_m: Array
    orientation_wxyz: Array
    velocity_enu_m_s: Array
    angular_velocity_flu_rad_s: Array
    rotor_speed_rad_s: Array
    specific_force_flu_m_s2: Array
    surface: Surface


class Deck(Struct, frozen=True, kw_only=True, eq=False):
    """The vehicle under the drone at `t_ns`, a box whose top face is the roof.

    Attributes:
        position_enu_m: (3,) the point on the road under the middle of the body, p_WV.
        orientation_wxyz: (4,) q_WV.
        velocity_enu_m_s: (3,).
        angular_velocity_enu_rad_s: (3,) in W.
        roof_size_m: length (x of V) and width (y of V) of the body.
        roof_height_m: of the roof above `position_enu_m`, along z of V; 0 is a pad on the road.
        is_afloat: it is on the sea, and no road leads it up and down.
        lowest_m: height in W of the lowest road that it has been on.
    """

    t_ns: int
    position_enu_m: Array
    orientation_wxyz: Array
    velocity_enu_m_s: Array
    angular_velocity_enu_rad_s: Array
    roof_size_m: tuple[float, float]
    roof_height_m: float
    is_afloat: bool = False
    lowest_m: float = inf

    @property
    def road_m(self) -> float:
        """Height in W of the road that it is on; of the sea it is that at rest."""
        return 0.0 if self.is_afloat else float(self.position_enu_m[2])


class AttitudeTarget(Struct, frozen=True, kw_only=True, eq=False):
    """An attitude to turn to, or turn rates alone, and the thrust.

    Attributes:
        orientation_wxyz: (4,) q_WB; None follows the rates alone.
        rates_flu_rad_s: (3,) w_WB in B.
        thrust_m_s2: along z of B, over the mass.
    """

    orientation_wxyz: Array | None
    rates_flu_rad_s: Array
    thrust_m_s2: float


class Reference(Struct, frozen=True, kw_only=True, eq=False):
    """What the flight controller is to follow; a None group is free (no feedback, no feed-forward).

    Attributes:
        position_enu_m: (3,); a None here with a velocity given flies the velocity.
        velocity_enu_m_s: (3,) feed-forward with a position, else the target.
        acceleration_enu_m_s2: (3,) feed-forward.
        yaw_rad: None holds the present heading.
        yaw_rate_rad_s: None is zero.
        attitude: in place of everything above.
        free_position: axes of W on which the position is nobody's wish, and follows the drone.
        free_velocity: axes of W on which the velocity is nobody's wish, and follows the drone's.
    """

    position_enu_m: Array | None
    velocity_enu_m_s: Array | None
    acceleration_enu_m_s2: Array | None
    yaw_rad: float | None
    yaw_rate_rad_s: float | None = None
    attitude: AttitudeTarget | None = None
    free_position: tuple[bool, bool, bool] = (False, False, False)
    free_velocity: tuple[bool, bool, bool] = (False, False, False)

    @property
    def height_m(self) -> float | None:
        """The height in W that is asked for, None where none is."""
        return None if self.position_enu_m is None or self.free_position[2] else float(self.position_enu_m[2])
