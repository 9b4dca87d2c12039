"""How a vehicle changes the air about it: the flow that follows its body, and the wake behind it.

What is in the air stream is a box on a plane: a vehicle on its road, a superstructure on its deck.

- The half ellipsoid in that box, mirrored in the plane, turns the stream aside without friction. For a stream u along x
  `phi = u x (1 + a(l) / (2 - a(0)))` with `a(l) = abc int_l^inf ds / ((a^2 + s) D(s))`, and l the one of the confocal
  ellipsoid (Lamb, Hydrodynamics, sections 111 and 114). The air just over a car's roof is 1.2 times as fast as the
  stream.
- Behind the box the air stays behind. The cavity is `Lr = 1.8 W / ((L / H)^0.3 (1 + 0.24 W / H))` long, with L / H from
  0.3 to 3 (Hosker 1984). It is an ellipsoid about the foot of the rear face. In it the air flows back with
  `u (1 - s / d)^2`, behind it with `u (1 - (d / s)^1.5)`. Here s is the way from the rear face, d the cavity's length
  at this place (Roeckle 1990; Kaplan and Dinar 1996). W is the box's size across the stream, L along it.
- The wake's turbulence is a quarter of what the air stays behind. Over the flight decks of frigates 20 to 30 % of the
  stream are measured.

No air flows up or down in the wake, none stays behind in front of the box, and none leaves a blunt front.
"""

from dataclasses import dataclass, field
from functools import lru_cache
from math import hypot, inf, sqrt

from msgspec import Struct
from scipy.special import elliprd

Triple = tuple[float, float, float]

TURBULENCE = 0.25
FLOW_REACH = 4.0
WAKE_REACH = 20.0
"""In sizes of the box, beyond which less than a hundredth is left of either."""
_ROOT_STEPS = 30
_ROOT_RELATIVE = 1e-9


class Flow(Struct, frozen=True, kw_only=True):
    """The air at a place, against the stream far away.

    Attributes:
        change_m_s: (3,) of the mean.
        turbulence_m_s: standard deviation on each axis.
    """

    change_m_s: Triple
    turbulence_m_s: float


NO_CHANGE = Flow(change_m_s=(0.0, 0.0, 0.0), turbulence_m_s=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Obstacle:
    """A box in the air stream, in the frame V of its vehicle.

    Attributes:
        length_m: along x.
        width_m: along y.
        height_m: above its foot.
        ahead_m: x of its middle.
        foot_m: z of the plane that it stands on.
        squares: (3,) of the ellipsoid's half axes, m^2, derived.
        excess: (2,) `1 / (2 - a(0))` of streams along x and y, derived.
    """

    length_m: float
    width_m: float
    height_m: float
    ahead_m: float = 0.0
    foot_m: float = 0.0
    squares: Triple = field(init=False, repr=False, compare=False)
    excess: tuple[float, float] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Derive what does not change."""
        squares = 0.25 * self.length_m**2, 0.25 * self.width_m**2, self.height_m**2
        along, across = _coefficients(squares, 0.0)
        object.__setattr__(self, "squares", squares)
        object.__setattr__(self, "excess", (1.0 / (2.0 - along), 1.0 / (2.0 - across)))


@lru_cache(maxsize=16)
def body_of(size_m: tuple[float, float], height_m: float) -> Obstacle | None:
    """Return a vehicle's body of this length, width and height; a pad on the road is none."""
    return None if height_m == 0.0 else Obstacle(length_m=size_m[0], width_m=size_m[1], height_m=height_m)


def flow_at(obstacle: Obstacle, place_flu_m: Triple, stream_m_s: tuple[float, float]) -> Flow:
    """Return the air near an obstacle.

    Args:
        obstacle: what is in the way.
        place_flu_m: in V.
        stream_m_s: level velocity of the air far away against the vehicle, in V.
    """
    place_m = place_flu_m[0] - obstacle.ahead_m, place_flu_m[1], place_flu_m[2] - obstacle.foot_m
    speed_m_s, away_m = hypot(*stream_m_s), hypot(*place_m)
    size_m = max(obstacle.length_m, obstacle.width_m, obstacle.height_m)
    if speed_m_s == 0.0 or place_m[2] < 0.0 or away_m > WAKE_REACH * size_m:
        return NO_CHANGE
    about = _about(obstacle, place_m, stream_m_s) if away_m < FLOW_REACH * size_m else (0.0, 0.0, 0.0)
    if about is None:
        return NO_CHANGE
    share = _share(obstacle, place_m, (stream_m_s[0] / speed_m_s, stream_m_s[1] / speed_m_s))
    behind = share - 1.0
    change_m_s = (
        about[0] * share + stream_m_s[0] * behind,
        about[1] * share + stream_m_s[1] * behind,
        about[2] * share,
    )
    return Flow(change_m_s=change_m_s, turbulence_m_s=TURBULENCE * speed_m_s * min(1.0, -behind))


def _about(obstacle: Obstacle, place_m: Triple, stream_m_s: tuple[float, float]) -> Triple | None:
    """Return what the ellipsoid adds to the stream at a place from its middle, m/s; None inside of it."""
    squares = obstacle.squares
    shifted = _confocal(squares, place_m)
    if shifted is None:
        return None
    grown = squares[0] + shifted, squares[1] + shifted, squares[2] + shifted
    slope = place_m[0] / grown[0], place_m[1] / grown[1], place_m[2] / grown[2]
    shrunk = sqrt(squares[0] * squares[1] * squares[2] / (grown[0] * grown[1] * grown[2]))
    across = shrunk * 2.0 / (slope[0] ** 2 + slope[1] ** 2 + slope[2] ** 2)
    along_x, along_y = (one * share for one, share in zip(stream_m_s, obstacle.excess, strict=True))
    turned = across * (along_x * slope[0] + along_y * slope[1])
    coefficient_x, coefficient_y = _coefficients(squares, shifted)
    return along_x * coefficient_x - turned * slope[0], along_y * coefficient_y - turned * slope[1], -turned * slope[2]


def _coefficients(squares: Triple, shifted: float) -> tuple[float, float]:
    """Return Lamb's `a(l)` of a stream along x and of one along y."""
    a, b, c = squares[0] + shifted, squares[1] + shifted, squares[2] + shifted
    scale = 2.0 / 3.0 * sqrt(squares[0] * squares[1] * squares[2])
    return scale * float(elliprd(b, c, a)), scale * float(elliprd(a, c, b))


def _confocal(squares: Triple, place_m: Triple) -> float | None:
    """Return by how much the squared half axes of the confocal ellipsoid through a place are larger, None inside.

    What `sum x^2 / (a^2 + l)` is over 1 falls and is convex in l, so Newton's steps come up to the root from below.
    """
    a, b, c = squares
    x, y, z = place_m[0] ** 2, place_m[1] ** 2, place_m[2] ** 2
    largest = max(squares)
    shifted = max(0.0, x + y + z - largest)
    if shifted == 0.0 and x / a + y / b + z / c < 1.0:
        return None
    for _ in range(_ROOT_STEPS):
        p, q, r = 1.0 / (a + shifted), 1.0 / (b + shifted), 1.0 / (c + shifted)
        step = (x * p + y * q + z * r - 1.0) / (x * p * p + y * q * q + z * r * r)
        shifted += step
        if step <= _ROOT_RELATIVE * largest:
            break
    return shifted


def _share(obstacle: Obstacle, place_m: Triple, along: tuple[float, float]) -> float:
    """Return how much of the stream is left behind the box, from -1 to 1; `along` is the stream's direction."""
    x_m, y_m, z_m = place_m
    behind_m = _way_behind(obstacle, (x_m, y_m), along)
    if behind_m is None or z_m >= obstacle.height_m:
        return 1.0
    ahead, aside = abs(along[0]), abs(along[1])
    width_m = obstacle.width_m * ahead + obstacle.length_m * aside
    length_m = obstacle.length_m * ahead + obstacle.width_m * aside
    off_middle = 2.0 * (along[0] * y_m - along[1] * x_m) / width_m
    slim = width_m / obstacle.height_m
    stout = min(3.0, max(0.3, length_m / obstacle.height_m))
    cavity_m = 1.8 * width_m / (float(stout**0.3) * (1.0 + 0.24 * slim))
    round_m = (1.0 - (z_m / obstacle.height_m) ** 2) * (1.0 - off_middle**2)
    cavity_m *= sqrt(max(0.0, round_m))
    if behind_m < cavity_m:
        return -((1.0 - behind_m / cavity_m) ** 2)
    return 1.0 if behind_m == 0.0 else 1.0 - float((cavity_m / behind_m) ** 1.5)


def _way_behind(obstacle: Obstacle, place_m: tuple[float, float], along: tuple[float, float]) -> float | None:
    """Return the way from the box's rear along the stream to a place, m; None where the box is not upstream of it."""
    enters, leaves = -inf, inf
    for at_m, toward, half_m in zip(place_m, along, (0.5 * obstacle.length_m, 0.5 * obstacle.width_m), strict=True):
        if toward == 0.0:
            if abs(at_m) >= half_m:
                return None
            continue
        first, last = sorted(((at_m - half_m) / toward, (at_m + half_m) / toward))
        enters, leaves = max(enters, first), min(leaves, last)
    return enters if 0.0 <= enters < leaves else None
