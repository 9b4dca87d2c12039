"""Truth of simple landings and flights, made by formula."""

from dataclasses import dataclass

from link.frames.rotations import conjugate, quaternion_from_roll_pitch_yaw, rotate
from link.messages import BodyTruth, RotorTruth, Vector3
from link.records import replace
from scenarios.catalogue.catalogue import load_scenario
from scenarios.scoring.score import Score, score
from scenarios.scoring.touchdown import ScoreRules, rules_of
from sim_autopilot.physics.contact import CONTACT_POINTS_FLU_M
from tests.rotations import matrix_of

START_NS = 1_800_000_000_000_000_000
STEP_S = 0.01
DURATION_S = 16.0
CONTACT_S = 8.0037  # between two samples
HOVER_RAD_S = 742.7
STILL = (0.0, 0.0, 0.0)
RULES = rules_of(load_scenario("straight_5"))
CALM = replace(RULES, drag_n_s_m=0.0)


@dataclass(frozen=True, kw_only=True)
class Landing:
    """A descent in a straight line, seen from a vehicle that drives along x, and rest on the deck from contact on."""

    error_m: tuple[float, float] = (0.1, 0.0)
    drift_m_s: tuple[float, float] = (0.0, 0.0)
    sink_m_s: float = 0.4
    tilt_rad: float = 0.0
    vehicle_m_s: float = 5.0
    roof_m: float = 1.5
    off_after_s: float | None = 1.0
    slide_m_s: float = 0.0

    @property
    def reach_m(self) -> float:
        """Of the lowest point below the centre of mass."""
        R_WB = matrix_of(quaternion_from_roll_pitch_yaw(0.0, self.tilt_rad, 0.0))
        return -float((CONTACT_POINTS_FLU_M @ R_WB.T)[:, 2].min())

    def drone(self, t_s: float) -> BodyTruth:
        before_s = CONTACT_S - t_s
        if before_s > 0.0:
            aside = [error - drift * before_s for error, drift in zip(self.error_m, self.drift_m_s, strict=True)]
            above_m, tilt_rad = self.reach_m + self.sink_m_s * before_s, self.tilt_rad
            velocity = (self.vehicle_m_s + self.drift_m_s[0], self.drift_m_s[1], -self.sink_m_s)
        else:
            aside = [self.error_m[0], self.error_m[1] - self.slide_m_s * before_s]
            above_m, tilt_rad, velocity = 0.119, 0.0, (self.vehicle_m_s, self.slide_m_s, 0.0)
        x_m = self.vehicle_m_s * (t_s - 2.0) + aside[0]
        return body(t_s, (x_m, aside[1], self.roof_m + above_m), velocity, tilt_rad)

    def vehicle(self, t_s: float) -> BodyTruth:
        return body(t_s, (self.vehicle_m_s * (t_s - 2.0), 0.0, 0.0), (self.vehicle_m_s, 0.0, 0.0))

    def rotors(self, t_s: float) -> RotorTruth:
        off = self.off_after_s is not None and t_s >= CONTACT_S + self.off_after_s
        return rotors(t_s, 0.0 if off else HOVER_RAD_S)


def at_ns(t_s: float) -> int:
    return START_NS + round(t_s * 1e9)


def body(
    t_s: float, position: Vector3, velocity_enu: Vector3, pitch_rad: float = 0.0, roll_rad: float = 0.0
) -> BodyTruth:
    q_WB = quaternion_from_roll_pitch_yaw(roll_rad, pitch_rad, 0.0)
    return BodyTruth(
        t_ns=at_ns(t_s),
        position_enu_m=position,
        orientation_wxyz=q_WB,
        velocity_flu_m_s=rotate(conjugate(q_WB), velocity_enu),
        angular_velocity_flu_rad_s=STILL,
    )


def rotors(t_s: float, speed_rad_s: float) -> RotorTruth:
    return RotorTruth(t_ns=at_ns(t_s), speed_rad_s=(speed_rad_s,) * 4)


TIMES_S = [index * STEP_S for index in range(round(DURATION_S / STEP_S))]


def scored(
    landing: Landing, rules: ScoreRules = CALM, until_s: float = DURATION_S, faults: tuple[str, ...] = ()
) -> Score:
    times_s = [t_s for t_s in TIMES_S if t_s < until_s]
    return score(
        [landing.drone(t_s) for t_s in times_s],
        [landing.vehicle(t_s) for t_s in times_s],
        [landing.rotors(t_s) for t_s in times_s],
        rules,
        faults=faults,
    )


def flown(path: list[BodyTruth], rules: ScoreRules = CALM, speed_rad_s: float = HOVER_RAD_S) -> Score:
    """Return the score of a flight above a vehicle that is parked at the origin."""
    times_s = [(sample.t_ns - START_NS) * 1e-9 for sample in path]
    return score(
        path, [body(t_s, STILL, STILL) for t_s in times_s], [rotors(t_s, speed_rad_s) for t_s in times_s], rules
    )
