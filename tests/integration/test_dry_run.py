"""A dry run does everything but send setpoints and commands: what the companion really sends, seen on the wire."""

import pytest

from companion.situation.phases import Phase
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.transports.opening import open_transport
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.integration.observer import observer
from tests.integration.programs import Programs, until

pytestmark = pytest.mark.wire

ASKING = {mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, mavlink.MAV_CMD_REQUEST_MESSAGE}
"""Without these it would learn nothing of the drone; they move nothing."""


def test_a_dry_run_goes_through_the_phases_but_sends_no_setpoint_and_no_command_to_fly() -> None:
    world_port, companion_port, endpoint = free_udp_port(), free_udp_port(), free_tcp_endpoint()
    said: list[Message] = []
    codec = MavlinkCodec(1, mavlink.MAV_COMP_ID_AUTOPILOT1)
    with (
        Programs() as programs,
        observer(endpoint) as bystander,
        open_transport(f"udpin:127.0.0.1:{world_port}") as to_world,
        open_transport(f"udpout:127.0.0.1:{companion_port}") as to_companion,
    ):
        companion = ("--mavlink", f"udpin:127.0.0.1:{companion_port}", "-e", endpoint, "--use-sim-time")
        programs.start("companion", *companion, "--start", "--dry-run")
        world = ("--mavlink", f"udpout:127.0.0.1:{world_port}", "-l", endpoint, "--speed", "4")
        programs.start("scenarios", "world", "straight_5", *world)

        def wants_to_fly_for_two_seconds() -> bool:
            to_companion.send(to_world.receive(0.005))
            from_companion = to_companion.receive(0.0)
            said.extend(codec.decode(from_companion))
            to_world.send(from_companion)
            bystander.listen()
            flying = [one.stamp_ns for one in bystander.recording.statuses if one.phase == Phase.TAKEOFF.value]
            truths_ns = [truth.t_ns for truth in bystander.recording.drone]  # another session: they may come later
            return bool(flying and truths_ns) and truths_ns[-1] - flying[0] > 2_000_000_000

        until(wants_to_fly_for_two_seconds, "two seconds of take-off")
    commands = {message.command for message in said if message.get_type() in {"COMMAND_LONG", "COMMAND_INT"}}
    assert commands == ASKING
    assert not [message for message in said if message.get_type().startswith("SET_")]
    assert not any(status.armed for status in bystander.recording.statuses)
    heights_m = [truth.position_enu_m[2] for truth in bystander.recording.drone]
    assert max(heights_m) - min(heights_m) < 0.01
