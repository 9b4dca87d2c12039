"""A landing by the shipped Zenoh files, while strangers of every kind try to take part."""

from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import pytest

from companion.runtime.claims import Claims
from link.errors import UserError
from link.messages import Command, Order
from link.payloads import json_messages
from link.zenoh.inbox import Inbox
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, ZenohSession, open_session
from scenarios.processes.programs import free_udp_port
from scenarios.recordings.result import LANDED
from tests.integration.observer import PASSES_SOON, Observer
from tests.integration.programs import Programs, until
from tests.security.secured import STRANGER, Secured, secured

# Forty seconds of waiting, since simulated time, which would be faster, is denied to all by these files.
pytestmark = pytest.mark.wire

KEYS = Keys()
FORGED = b"forged"


class Stranger:
    """Somebody who listens to everything, orders and forges."""

    def __init__(self, zenoh: ZenohSession) -> None:
        self._zenoh = zenoh
        self._inbox: Inbox = zenoh.subscribe(f"{KEYS.namespace}/**")
        self._asked: list[Inbox] = []

    def forge(self, *keys: str) -> None:
        """Publish on `keys`."""
        for key in keys:
            self._zenoh.publish(key, FORGED, "application/json")

    def claim(self) -> None:
        """Say that a companion of this drone runs, and was there first."""
        self._zenoh.declare_alive(KEYS.companion_alive("0"))

    def order(self) -> None:
        """Ask for the landing's end."""
        self._asked.append(
            self._zenoh.ask(KEYS.landing_command, json_messages.encode(Order(command=Command.HOLD)), 2.0)
        )

    @property
    def heard(self) -> int:
        """How much it was told: samples of others, and answers."""
        return sum(sample.payload != FORGED for sample in self._inbox.take()) + sum(
            len(inbox.take()) for inbox in self._asked
        )


def refused(options: ZenohOptions, why: str) -> None:
    """See that nobody gets in by `options`, and is told why."""
    with pytest.raises(UserError, match=why):
        open_session(options)


def strangers(stack: ExitStack, files: Secured, other: Path) -> list[Stranger]:
    """Return those who do get a connection, having tried those who do not, all at once: each waits for 5 s."""
    plain = files.endpoint.replace("tls/", "tcp/")
    without = files.folder / "without.json5"
    tls = f"root_ca_certificate: '{files.folder}/ca.pem'"
    without.write_text(f"{{transport: {{link: {{tls: {{{tls}}}}}}}}}", encoding="utf-8")
    outside = {
        ZenohOptions(mode="client", connect=(plain,)): "not met as tcp/",
        ZenohOptions(mode="client", connect=(files.endpoint,), config_file=without): "it refuses this certificate",
        ZenohOptions(mode="client", config_file=files.file("companion", authority=other)): "its certificate is refused",
    }
    with ThreadPoolExecutor() as at_once:
        assert len(list(at_once.map(refused, outside, outside.values()))) == len(outside)
    unknown = ZenohOptions(config_file=files.file("companion", certificate=STRANGER))
    return [Stranger(stack.enter_context(open_session(unknown)))]


def test_landing_by_the_shipped_files_is_told_to_no_stranger_and_ended_by_none(tmp_path: Path) -> None:
    files, other = secured(tmp_path / "keys"), secured(tmp_path / "other")
    device = f"127.0.0.1:{free_udp_port()}"

    def as_(name: str) -> tuple[str, str]:
        return "--zenoh-config", str(files.file(name))

    with Programs() as programs, ExitStack() as stack:
        programs.start("scenarios", "world", PASSES_SOON, "--mavlink", f"udpout:{device}", *as_("vehicle"))
        operator_options = ZenohOptions(config_file=files.file("operator"))
        sessions: list[ZenohSession] = []

        def is_up() -> bool:
            try:
                sessions.append(stack.enter_context(open_session(operator_options)))
            except UserError:
                return False
            return True

        until(is_up, "the vehicle listens")
        bystander, crooked = Observer(sessions[0], KEYS), Stranger(sessions[0])
        companion = programs.start("companion", "--mavlink", f"udpin:{device}", *as_("companion"))
        bystander.wait_for_relative_position()
        intruders = strangers(stack, files, other.folder)
        for impostor in (crooked, *intruders):
            impostor.claim()
        second = Claims(stack.enter_context(open_session(ZenohOptions(config_file=files.file("companion")))), KEYS)
        until(lambda: second.rival is not None, "a second companion knows of the first")
        start = programs.start("scenarios", "command", "start", *as_("operator"))
        assert (start.wait(), start.out.all) == (0, ["accepted"])

        def disturb() -> None:
            for intruder in intruders:
                intruder.forge(KEYS.fix, KEYS.imu, KEYS.landing_status)
                intruder.order()
            crooked.forge(KEYS.fix, KEYS.fix_velocity, KEYS.imu)  # an operator is no vehicle

        assert bystander.wait_for_end(disturb).tier in LANDED
        refused = {one.links.refused for one in bystander.recording.statuses}
        assert bystander.recording.statuses[-1].links.zenoh_bad_payloads == 0, refused
        assert [intruder.heard for intruder in intruders] == [0]
        assert companion.runs
