"""Attacks on a companion that runs, on the bench, and what its status says of them.

The operator's own session watches; the attacker has a session without a certificate, and a socket of its own.
"""

import re
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, suppress

from link.errors import UserError
from link.mavlink.codec import MavlinkCodec
from link.messages import Command, LandingStatus, Order
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.transports.device import parse_device
from link.transports.opening import open_transport
from link.transports.transport import Transport
from link.zenoh.keys import Keys
from link.zenoh.options import check_endpoint
from link.zenoh.session import ZenohOptions, ZenohSession, open_session
from scenarios.attack.attempt import Attempt
from scenarios.attack.crafted import CRAFTED, datagram_of
from scenarios.attack.flood import ANSWER_MAX_S, FLOOD_HZ, Flood, ask, order_of_many_names
from scenarios.attack.spoofs import SPOOFS, Now

_FIRST_S = 10.0  # for the first status
_STATUSES = 4  # that a spoof has time to show in
_GAP_MAX_S = 0.5  # of the status while bytes come that are slow to decode; it is published at 10 Hz
_REPEATS = 20
_FLOODS_S = 2.0  # before an abort is asked for
_ABORTS = 5
_LISTENS_S = 1.0
_ORDER_S = 2.0
_REACHED_S = 3.0  # of a host that answers nothing at all; a refusal comes at once
_BOOT_MS = 60_000
_BATTERY_LOST = 0.5  # the forged one has a hundredth left
_CONNECTING = ("tcp", "tls", "ws")  # the others begin nothing of which it could be told
_NOTHING = "changes nothing"
_GOES_ON = f"the status goes on within {_GAP_MAX_S:g} s"


class Watch:
    """The status of the companion that is attacked.

    Args:
        zenoh: the operator's session.
        keys: of the Zenoh contract.
    """

    def __init__(self, zenoh: ZenohSession, keys: Keys) -> None:
        self._zenoh = zenoh
        self._key = keys.landing_status
        self._inbox = zenoh.subscribe(self._key)

    def next(self, timeout_s: float) -> LandingStatus:
        """Return the next status.

        Raises:
            UserError: none comes.
        """
        end_s = time.monotonic() + timeout_s
        while time.monotonic() < end_s:
            for sample in self._inbox.take():
                with suppress(PayloadError):
                    return json_messages.decode(LandingStatus, sample.payload)
            self._zenoh.wake_up.wait(0.05)
        raise UserError(f"no companion tells its status on {self._key}: start it, or check --drone and -e")

    def after(self, count: int) -> LandingStatus:
        """Return the status after so many from now on."""
        self._inbox.take()
        for _ in range(count - 1):
            self.next(_FIRST_S)
        return self.next(_FIRST_S)

    def longest_gap_s(self, lasts_s: float) -> float:
        """Return for how long at most no status came, over a while."""
        self._inbox.take()
        began_s = last_s = time.monotonic()
        longest_s = 0.0
        while last_s - began_s < lasts_s:
            self.next(_FIRST_S)
            now_s = time.monotonic()
            longest_s, last_s = max(longest_s, now_s - last_s), now_s
        return longest_s


def attempts(options: ZenohOptions, keys: Keys, *, device: str | None, stranger: str | None) -> Iterator[Attempt]:
    """Attack a companion.

    Args:
        options: of the operator's session.
        keys: of the Zenoh contract.
        device: by which its MAVLink link is reached; None leaves that out.
        stranger: endpoint at which somebody without a certificate tries; None leaves that out.

    Raises:
        UserError: no companion is there, its motors run, or it hears no autopilot; nothing listens for the stranger.
    """
    # A mistake is told before anybody is waited for.
    if device is not None:
        parse_device(device)
    if stranger is not None:
        _check_reached(stranger)
    with ExitStack() as stack:
        zenoh = stack.enter_context(open_session(options))
        watch = Watch(zenoh, keys)
        if watch.next(_FIRST_S).armed:
            raise UserError("the motors run: disarm, and take the propellers off, before you attack")
        if stranger is not None:
            yield _by_stranger(stranger, keys)
        if device is not None:
            if not watch.after(1).flown_by:
                raise UserError("the companion hears no autopilot: connect it, for until then anybody may pose as one")
            transport = stack.enter_context(open_transport(device))
            yield from _by_mavlink(transport, watch)
        client = stack.enter_context(open_session(options))
        yield _by_large_orders(client, keys, watch)
        yield _by_flood(zenoh, client, keys)


def _check_reached(endpoint: str) -> None:
    """Find out whether something listens where the stranger tries: who gets no connection elsewhere shows nothing."""
    check_endpoint("--stranger", endpoint, port_min=1)
    protocol, _, address = endpoint.partition("/")
    if protocol not in _CONNECTING:
        return
    host, _, port = re.split("[?#]", address)[0].rpartition(":")
    try:
        socket.create_connection((host.strip("[]"), int(port)), _REACHED_S).close()
    except OSError as error:
        raise UserError(
            f"--stranger {endpoint}: nothing listens there ({error.strerror or error}); name where the vehicle or the"
            " router listens"
        ) from error


def _by_stranger(endpoint: str, keys: Keys) -> Attempt:
    expected = "gets no connection"
    try:
        with open_session(ZenohOptions(mode="client", connect=(endpoint,), insecure=True)) as zenoh:
            inbox = zenoh.subscribe(f"{keys.namespace}/**")
            order = json_messages.encode(Order(command=Command.HOLD))
            answers = zenoh.query(keys.landing_command, order, _ORDER_S)
            time.sleep(_LISTENS_S)
            seen = f"reads {len(inbox.take())} samples, and {len(answers)} answer its order"
    except UserError:
        seen = expected
    return Attempt(by="Zenoh, no certificate", what=f"orders a hold at {endpoint}", expected=expected, seen=seen)


def _by_mavlink(transport: Transport, watch: Watch) -> Iterator[Attempt]:
    by = "MAVLink, another port"
    for name, spoof in SPOOFS.items():
        before = watch.after(1)
        transport.send(MavlinkCodec(1, 1).encode(spoof(Now(boot_ms=_BOOT_MS, utc_us=time.time_ns() // 1000))))
        seen = _difference(before, watch.after(_STATUSES))
        yield Attempt(by=by, what=f"forges {name}", expected=_NOTHING, seen=seen)
    for kind in CRAFTED:
        for _ in range(_REPEATS):
            transport.send(datagram_of(kind))
        yield Attempt(by=by, what=f"{_REPEATS} datagrams of {kind}", expected=_GOES_ON, seen=_goes_on(watch))


def _goes_on(watch: Watch) -> str:
    gap_s = watch.longest_gap_s(_LISTENS_S)
    return _GOES_ON if gap_s < _GAP_MAX_S else f"the status stops for {gap_s:.1f} s"


def _difference(before: LandingStatus, after: LandingStatus) -> str:
    changed = [name for name in ("phase", "armed", "flown_by") if getattr(before, name) != getattr(after, name)]
    if (before.battery_share or 0.0) - (after.battery_share or 0.0) > _BATTERY_LOST:
        changed.append("battery_share")
    return f"changes {', '.join(changed)}" if changed else _NOTHING


def _by_large_orders(client: ZenohSession, keys: Keys, watch: Watch) -> Attempt:
    order = order_of_many_names()
    for _ in range(_REPEATS):
        client.ask(keys.landing_command, order, _ORDER_S)
    what = f"{_REPEATS} orders of {len(order) / 1e6:.1f} MB"
    return Attempt(by="Zenoh, operator's rights", what=what, expected=_GOES_ON, seen=_goes_on(watch))


def _by_flood(operator: ZenohSession, client: ZenohSession, keys: Keys) -> Attempt:
    expected = f"an abort is answered within {ANSWER_MAX_S:g} s"
    with Flood(client, keys, Command.HOLD):
        time.sleep(_FLOODS_S)
        answers = [ask(operator, keys, Command.ABORT) for _ in range(_ABORTS)]
    waited_s = sorted(wait_s for _, wait_s in answers)[_ABORTS // 2]
    is_answered = all(reply is not None for reply, _ in answers)
    seen = f"an abort is answered after {waited_s:.1f} s" if is_answered else "an abort is not answered"
    return Attempt(
        by="Zenoh, operator's rights",
        what=f"{FLOOD_HZ:g} commands a second",
        expected=expected,
        seen=expected if is_answered and waited_s < ANSWER_MAX_S else seen,
    )
