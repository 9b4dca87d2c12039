"""What makes a run unsafe, read from ground truth: each fault is its instant and a sentence."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.scoring.touch import Box, Contact, Flags, Touches, contact_at, contact_starts
from scenarios.scoring.truth_log import TruthLog
from sim_autopilot.core.data import Surface

Fault = tuple[int, str]

MOTORS_OFF_RAD_S = 50.0  # of a hover's 743: 0.5 % of the weight
TAKEN_OFF_M = 0.5  # of the lowest point over what is below it
IN_AIR_M = 0.3
_APART_S = 0.3  # contacts closer in time than this are one landing, bounces included
TIPPED_ON_DECK_RAD = math.radians(45.0)
TIPPED_IN_AIR_RAD = math.radians(80.0)
CLEAR_M = 1.0  # at the end, of feet and blades from vehicle and ground: three times the reach of the blades
STABLE_S = 1.0
STABLE_TILT_RAD = math.radians(50.0)  # the airframe's limit is 45 degrees
STABLE_RATE_RAD_S = 2.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Flight:
    """The sample of take-off, None without one, and the contacts after it."""

    takeoff: int | None
    contacts: tuple[Contact, ...]

    @property
    def first(self) -> Contact | None:
        """The first contact."""
        return self.contacts[0] if self.contacts else None


def flight_of(log: TruthLog, touched: Touches, box: Box) -> Flight:
    """Return when the drone took off and what it touched from then on."""
    risen = np.flatnonzero(touched.height_m.min(axis=1) > TAKEN_OFF_M)
    if not len(risen):
        return Flight(takeoff=None, contacts=())
    takeoff = int(risen[0])
    starts = contact_starts(log.t_ns, touched.any, from_index=takeoff, apart_s=_APART_S)
    return Flight(takeoff=takeoff, contacts=tuple(contact_at(log, touched, index, box) for index in starts))


def motors_off_index(log: TruthLog, from_index: int) -> int | None:
    """Return the first sample from `from_index` on at which no rotor turns any more, None without one."""
    if log.rotor_speed_rad_s is None:
        return None
    off = np.flatnonzero((log.rotor_speed_rad_s[from_index:] < MOTORS_OFF_RAD_S).all(axis=1))
    return from_index + int(off[0]) if len(off) else None


def flight_faults(log: TruthLog, touched: Touches, flight: Flight, *, outside: Flags) -> list[Fault]:
    """Return the faults of a flight; its limits at touchdown are not among them.

    Args:
        log: of the flight.
        touched: in it.
        flight: its take-off and contacts.
        outside: (n,) of the fence.
    """
    if flight.takeoff is None:
        return [(int(log.t_ns[-1]), "never took off")]
    in_air = touched.height_m.min(axis=1) > IN_AIR_M
    signs: list[tuple[Flags, str]] = [
        (np.asarray(touched.ground.any(axis=1)), "contact with the ground"),
        (np.asarray(touched.side.any(axis=1)), "contact with the vehicle's side"),
        (outside, "fence broken"),
        (tilts_rad(log.rotation) > TIPPED_IN_AIR_RAD, "tipped over"),
        (touched.any & (tilts_rad(log.rotation_vb) > TIPPED_ON_DECK_RAD), "tipped over on the deck"),
    ]
    if log.rotor_speed_rad_s is not None:
        signs.append((in_air & (log.rotor_speed_rad_s < MOTORS_OFF_RAD_S).all(axis=1), "motors off in the air"))
    faults = [
        (int(log.t_ns[flight.takeoff + int(np.argmax(sign[flight.takeoff :]))]), text)
        for sign, text in signs
        if sign[flight.takeoff :].any()
    ]
    beside = [contact for contact in flight.contacts if contact.surface is Surface.DECK and not contact.on_pad]
    faults += [(contact.t_ns, "contact with the roof outside the pad") for contact in beside]
    return faults if flight.contacts else faults + _end_faults(log, touched)


def tilts_rad(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the angle (n,) between the two z axes of `rotation` (n, 3, 3)."""
    return np.asarray(np.arccos(np.clip(rotation[:, 2, 2], -1.0, 1.0)))


def _end_faults(log: TruthLog, touched: Touches) -> list[Fault]:
    """Return what keeps a flight without contact from being a clean abort."""
    end_ns = int(log.t_ns[-1])
    # A flank that is driven into is no better than a roof that is flown into: all directions count.
    if float(np.minimum(touched.height_m[-1], touched.from_box_m[-1]).min()) <= CLEAR_M:
        return [(end_ns, "ends close to the vehicle or the ground")]
    last = log.t_ns >= end_ns - round(STABLE_S * 1e9)
    steady = (tilts_rad(log.rotation[last]) <= STABLE_TILT_RAD) & (log.rate_rad_s[last] <= STABLE_RATE_RAD_S)
    return [] if steady.all() else [(end_ns, "ends unstable")]
