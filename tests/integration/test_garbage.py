"""A landing while somebody throws random bytes at the companion's port and at every Zenoh key."""

import json
import random
from pathlib import Path

import pytest

from companion.situation.phases import Phase
from link.transports.opening import Transport, open_transport
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, ZenohSession, open_session
from scenarios.recordings.result import LANDED
from scenarios.scoring.score import Tier
from tests.integration.observer import PASSES_SOON, Observer
from tests.integration.programs import Program, Programs, until

pytestmark = pytest.mark.wire

KEYS = Keys()
HEARD = (KEYS.fix, KEYS.fix_velocity, KEYS.imu, KEYS.pad_pose, KEYS.clock)
"""What the companion takes in; it does not listen to the others, but the simulator and the run do."""
SPOKEN = (KEYS.landing_status, KEYS.landing_plan, KEYS.drone_truth, KEYS.vehicle_truth, KEYS.drone_rotors)


def option_of(run: Program, program: str, option: str) -> str:
    """Return what a program of the run was given for an option, once it is there."""
    found: list[str] = []

    def is_there() -> bool:
        lines = [child.cmdline() for child in run.children()]
        found.extend(line[line.index(option) + 1] for line in lines if program in line and option in line)
        return bool(found) or run.out.finished(0.01)

    until(is_there, f"{program} with {option}")
    return found[0]


class Thrower:
    """Random bytes from a fixed seed, some of which look like the beginning of a MAVLink frame or a CDR payload."""

    def __init__(self, zenoh: ZenohSession, transport: Transport) -> None:
        self._zenoh = zenoh
        self._random = random.Random(7)
        self._transport = transport
        self.datagrams = 0

    def throw(self) -> None:
        """Throw once at everything."""
        for key in (*HEARD, *SPOKEN):
            self._zenoh.publish(key, self._bytes((b"", b"\x00\x01\x00\x00", b"{")), "application/cdr;garbage")
        self._transport.send(self._bytes((b"", b"\xfd\x10\x00\x00", b"\xfe\x09")))
        self.datagrams += 1

    def _bytes(self, heads: tuple[bytes, ...]) -> bytes:
        return self._random.choice(heads) + self._random.randbytes(self._random.randrange(64))


def test_garbage_on_the_port_and_on_every_key_is_counted_and_the_landing_succeeds(tmp_path: Path) -> None:
    with Programs() as programs:
        run = programs.start("scenarios", "run", PASSES_SOON, "--json", "--out", str(tmp_path))
        endpoint = option_of(run, "companion", "-e")
        device = option_of(run, "companion", "--mavlink")
        with (
            open_session(ZenohOptions(connect=(endpoint,))) as zenoh,
            open_transport(device.replace("udpin", "udpout")) as transport,
        ):
            bystander, thrower = Observer(zenoh, KEYS), Thrower(zenoh, transport)
            bystander.wait_for_status()
            while not run.out.finished(0.02):
                for _ in range(4):
                    thrower.throw()
                bystander.hear()
        assert run.wait() == 0, (run.err.all, run.out.all)
    last = bystander.recording.statuses[-1]
    flies = next(one for one in bystander.recording.statuses if one.phase == Phase.TAKEOFF.value)
    assert Tier(json.loads("\n".join(run.out.all))["tier"]) in LANDED
    assert thrower.datagrams > 100
    assert last.links.zenoh_bad_payloads > 100
    assert last.links.mavlink_bad_bytes == flies.links.mavlink_bad_bytes  # nobody but the autopilot is listened to
