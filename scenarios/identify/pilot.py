"""Flies the manoeuvres with an autopilot and notes where it was, by the companion's driver; without I/O.

The way is flown by the autopilot's own clock: a simulation's may be 2 % slower than ours, and a velocity that does not
belong to its places is not followed by anybody.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np

from companion.autopilots.driver import Desire, DriverMemory
from companion.autopilots.link import AutopilotLink
from companion.autopilots.response import Cascade, Shaping
from companion.core.data import Array, OwnState, Setpoint
from link.errors import UserError
from link.mavlink.session import MavlinkSession
from link.records import replace
from scenarios.identify.manoeuvres import DURATION_S, wish_at

HEIGHT_M = 12.0
"""Above the place of take-off: a sink that overshoots by metres stays clear of the ground and its effect."""
_PERIOD_NS = 20_000_000
"""Of setpoints, as the companion sends them."""
_READY_S, _RISE_S = 90.0, 60.0
_NEAR_M, _SLOW_M_S, _QUIET_S = 0.4, 0.3, 3.0
_SYSTEM_ID = 1
_REPORTS_HZ = 50.0


class Stage(Enum):
    """Of the flight."""

    WAIT = 0
    RISE = 1
    FLY = 2
    DONE = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Flight:
    """What an autopilot made of the manoeuvres.

    Attributes:
        autopilot: its driver's name.
        t_s: (n,) of its reports since the first manoeuvre began, by its clock.
        position_m: (n, 3) in W, from where the first manoeuvre began.
        velocity_m_s: (n, 3) as it reported.
        cascade: its gains, by its parameters.
        shaping: its path's limits, by its parameters; None if it has none.
    """

    autopilot: str
    t_s: Array
    position_m: Array
    velocity_m_s: Array
    cascade: Cascade
    shaping: Shaping | None


class Pilot:
    """One flight of all manoeuvres, driven by bytes and time.

    Args:
        device: of the link, for messages.
    """

    def __init__(self, device: str) -> None:
        self._device = device
        self._link = AutopilotLink(MavlinkSession(_SYSTEM_ID), motion_rate_hz=_REPORTS_HZ)
        self._memory = DriverMemory()
        self._stage = Stage.WAIT
        self._since_ns: int | None = None
        self._quiet_ns: int | None = None
        self._sent_ns = 0
        self._base: OwnState | None = None
        self._began_ns = 0
        self._rows: list[tuple[float, ...]] = []
        self._noted_ns = 0

    @property
    def is_done(self) -> bool:
        """Whether all manoeuvres are flown."""
        return self._stage is Stage.DONE

    @property
    def stage(self) -> Stage:
        """Of the flight."""
        return self._stage

    def receive(self, data: bytes, local_ns: int, *, is_datagram: bool = False) -> None:
        """Take bytes of the autopilot.

        Raises:
            UserError: it is of a kind that cannot be flown.
        """
        self._link.receive(data, local_ns, is_datagram=is_datagram)
        self._note(local_ns)

    def poll(self, local_ns: int) -> list[bytes]:
        """Do what is due, and return the frames to be sent.

        Raises:
            UserError: the autopilot is not heard, does not take off in time, or has left the flight.
        """
        self._link.poll(local_ns)
        self._since_ns = local_ns if self._since_ns is None else self._since_ns
        own = self._link.state.own
        if self._stage is Stage.WAIT:
            self._wait(own, local_ns)
        elif local_ns - self._sent_ns >= _PERIOD_NS:
            self._sent_ns = max(self._sent_ns + _PERIOD_NS, local_ns - _PERIOD_NS)
            self._fly(local_ns)
        return self._link.session.take_output()

    def flight(self) -> Flight:
        """Return what was flown.

        Raises:
            UserError: the autopilot has not told where it was.
        """
        rows = np.array(self._rows)
        driver, cascade = self._link.driver, self._link.cascade
        if driver is None or cascade is None or len(rows) < _REPORTS_HZ:
            raise UserError(f"{self._device}: hardly any position came: raise the link's baud rate or shorten it")
        return Flight(
            autopilot=driver.name,
            t_s=rows[:, 0],
            position_m=rows[:, 1:4],
            velocity_m_s=rows[:, 4:7],
            cascade=cascade,
            shaping=self._link.shaping,
        )

    def _wait(self, own: OwnState | None, local_ns: int) -> None:
        view = self._link.state.view
        if own is not None and self._link.driver is not None and self._link.session.clock.local_to_boot is not None:
            if view.armed and view.landed is False:
                raise UserError(f"{self._device}: the drone flies already: let it stand, disarmed")
            self._base, self._stage, self._since_ns = own, Stage.RISE, local_ns
            return
        self._expect(local_ns, _READY_S, self._missing())

    def _missing(self) -> str:
        if self._link.driver is None:
            return "no heartbeat of an autopilot came; check --mavlink and that it runs"
        return "it tells no position; wait for its estimator, then try again"

    def _fly(self, local_ns: int) -> None:
        driver, base = self._link.driver, self._base
        if driver is None or base is None:
            raise ValueError("the flight has begun without an autopilot")
        flying = self._stage is Stage.FLY
        desire = Desire(control=True, armed=True, takeoff_height_m=HEIGHT_M)
        view = self._link.state.view
        if flying and not (view.in_control and view.armed):
            raise UserError(f"{self._device}: the autopilot has left the flight: see its own messages, then try again")
        self._memory, commands = driver.act(self._memory, view, desire, local_ns)
        for command, result in self._link.take_acknowledgements():
            self._memory = driver.acknowledged(self._memory, command, result)
        self._link.send_commands(commands, local_ns)
        if not self._memory.climbs_by_itself:
            self._send(base, local_ns)
        if self._stage is Stage.RISE:
            self._rise(base, local_ns)
        elif self._flown_s(local_ns) >= DURATION_S:
            self._memory, commands = driver.act(self._memory, view, Desire(release=True), local_ns)
            self._link.send_commands(commands, local_ns)
            self._stage = Stage.DONE

    def _rise(self, base: OwnState, local_ns: int) -> None:
        own, view = self._link.state.own, self._link.state.view
        texts = " ".join((*self._link.take_texts(), view.refusal or ""))
        self._expect(local_ns, _RISE_S, f"it did not rise to {HEIGHT_M:g} m; {texts or 'see its own messages'}")
        if own is None:
            return
        off_m = own.position_enu_m[2] - base.position_enu_m[2] - HEIGHT_M
        is_quiet = abs(off_m) < _NEAR_M and max(map(abs, own.velocity_enu_m_s)) < _SLOW_M_S and view.armed
        self._quiet_ns = (self._quiet_ns or local_ns) if is_quiet else None
        if self._quiet_ns is not None and (local_ns - self._quiet_ns) * 1e-9 >= _QUIET_S:
            x, y, z = base.position_enu_m
            self._stage, self._began_ns = Stage.FLY, self._boot_ns(local_ns)
            self._base = replace(base, position_enu_m=(x, y, z + HEIGHT_M))

    def _send(self, base: OwnState, local_ns: int) -> None:
        place, velocity, acceleration = wish_at(self._flown_s(local_ns) if self._stage is Stage.FLY else 0.0)
        x, y, z = base.position_enu_m
        up_m = 0.0 if self._stage is Stage.FLY else HEIGHT_M
        setpoint = Setpoint(
            t_ns=local_ns,
            position_enu_m=(x + place[0], y + place[1], z + up_m + place[2]),
            velocity_enu_m_s=velocity,
            acceleration_enu_m_s2=acceleration,
            yaw_rad=0.0,
        )
        self._link.send_setpoint(setpoint, local_ns)

    def _note(self, local_ns: int) -> None:
        """Note a new report, at the time when it was so."""
        own, base = self._link.state.own, self._base
        if self._stage is not Stage.FLY or own is None or base is None or own.t_ns == self._noted_ns:
            return
        self._noted_ns = own.t_ns
        age_s = (self._link.session.clock.local_to_utc_ns(local_ns) - own.t_ns) * 1e-9
        place = np.subtract(own.position_enu_m, base.position_enu_m)
        velocity = np.add(own.velocity_enu_m_s, own.velocity_bias_enu_m_s)
        self._rows.append((self._flown_s(local_ns) - age_s, *place.tolist(), *velocity.tolist()))

    def _boot_ns(self, local_ns: int) -> int:
        boot_ns = self._link.session.clock.local_to_boot_ns(local_ns)
        if boot_ns is None:
            raise ValueError("the flight has begun without the autopilot's clock")
        return boot_ns

    def _flown_s(self, local_ns: int) -> float:
        return (self._boot_ns(local_ns) - self._began_ns) * 1e-9

    def _elapsed_s(self, local_ns: int) -> float:
        return 0.0 if self._since_ns is None else (local_ns - self._since_ns) * 1e-9

    def _expect(self, local_ns: int, limit_s: float, problem: str) -> None:
        if self._elapsed_s(local_ns) > limit_s:
            raise UserError(f"{self._device}: after {limit_s:g} s {problem}")
