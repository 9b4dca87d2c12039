"""A partner is killed without a word: the simulator in the flight, the vehicle in the chase."""

import pytest

from companion.situation.phases import Phase
from link.frames.rotations import rotate
from link.messages import BodyTruth
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from tests.integration.observer import PASSES_SOON, Observer, observer
from tests.integration.programs import Programs

pytestmark = pytest.mark.wire

# What a drone may still sink after the abort: while attitude (1 / MC_ROLL_P) and rotors lag it sinks ever faster,
# as it does then; afterwards it brakes with at least half of MPC_ACC_UP_MAX.
BRAKING_M_S2, REACTION_S, OWN_POSITION_M = 2.0, 0.3, 0.1


def sink_m_s(truth: BodyTruth) -> float:
    """Return how fast the drone sinks."""
    return -rotate(truth.orientation_wxyz, truth.velocity_flu_m_s)[2]


def braking_m(before: BodyTruth, aborted: BodyTruth) -> float:
    """Return by how much a drone may sink that sank so, shortly before the abort and at it."""
    faster_m_s2 = max(0.0, (sink_m_s(aborted) - sink_m_s(before)) / ((aborted.t_ns - before.t_ns) * 1e-9))
    sinks_m_s = max(0.0, sink_m_s(aborted))
    then_m_s = sinks_m_s + faster_m_s2 * REACTION_S
    return 0.5 * (sinks_m_s + then_m_s) * REACTION_S + then_m_s**2 / (2.0 * BRAKING_M_S2)


def start_again(programs: Programs, bystander: Observer, endpoint: str) -> None:
    """Command a start once the companion knows where everything is, and see the drone rise."""
    bystander.wait_for_relative_position()
    operator = programs.start("scenarios", "command", "start", "-e", endpoint)
    assert (operator.wait(), operator.out.all) == (0, ["accepted"])
    bystander.wait_for_phase(Phase.TAKEOFF)
    bystander.wait_for_height(1.0)


def test_the_companion_outlives_a_simulator_killed_in_flight_and_flies_with_the_next_one() -> None:
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    world = ("world", "straight_5", "--mavlink", f"udpout:127.0.0.1:{port}", "-l", endpoint)
    with Programs() as programs, observer(endpoint) as bystander:
        companion = programs.start("companion", "--mavlink", f"udpin:127.0.0.1:{port}", "-e", endpoint)
        first = programs.start("scenarios", *world)
        companion.out.wait_for("autopilot found")
        start_again(programs, bystander, endpoint)
        first.kill()
        companion.out.wait_for("autopilot lost")
        bystander.forget()
        programs.start("scenarios", *world)
        companion.out.wait_for("autopilot found again")
        start_again(programs, bystander, endpoint)
        assert companion.runs


def test_the_drone_climbs_away_when_the_vehicle_is_killed_in_the_chase() -> None:
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    with Programs() as programs, observer(endpoint) as bystander:
        vehicle = programs.start("ground-vehicle", "--scenario", PASSES_SOON, "--use-sim-time", "-l", endpoint)
        device = ("--mavlink", f"udpout:127.0.0.1:{port}")
        programs.start("sim-autopilot", *device, "--instant", "-e", endpoint)
        programs.start("companion", "--mavlink", f"udpin:127.0.0.1:{port}", "-e", endpoint, "--use-sim-time", "--start")
        bystander.wait_for_phase(Phase.CHASE, Phase.ALIGN)
        vehicle.kill()
        bystander.wait_for_phase(Phase.ABORT)
        assert bystander.recording.statuses[-1].reason in {"vehicle data too old", "vehicle's link lost"}
        drone, aborted_at_m, first = bystander.recording.drone, bystander.height_m, len(bystander.recording.drone)
        may_sink_m = braking_m(drone[-10], drone[-1])
        bystander.wait_for_phase(Phase.HOLD)
        heights_m = [truth.position_enu_m[2] for truth in bystander.recording.drone[first:]]
        assert min(heights_m) > aborted_at_m - may_sink_m - OWN_POSITION_M
        assert heights_m[-1] > aborted_at_m + 2.0
