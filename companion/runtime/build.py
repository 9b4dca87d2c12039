"""A companion from its configuration."""

from typing import assert_never, cast

import numpy as np

from companion.config.autopilot import UtcOf
from companion.config.companion import CompanionConfig
from companion.config.estimation import EstimatorKind
from companion.config.planning import GuidanceConfig, GuidanceKind, SolverKind
from companion.core.data import Array
from companion.forecast.steering import lean_change
from companion.forecast.warm_up import compile_rollout
from companion.landing.state.step_data import System
from companion.landing.steering.targets import way_down
from companion.planning.guidance import Guidance, GuidanceMemory, PlanRequest, ReferenceState, Target
from companion.planning.mpc import Mpc
from companion.planning.mpc_report import ReportMpc
from companion.planning.pn import ProportionalNavigation
from companion.runtime.node import CompanionNode
from companion.runtime.recorded_node import RecordingNode
from companion.vehicle.factory import make_estimator
from companion.vehicle.lever import tilted_lever, turned_lever, yaw_rate
from companion.vehicle.shake import tilted_deck
from link.mavlink.session import MavlinkSession
from link.mavlink.signing import Signing
from link.payloads import cdr
from link.program.extras import require
from link.recording.recorder import Recorder
from link.zenoh.keys import Keys


def warm_up(guidance: Guidance, config: CompanionConfig) -> None:
    """Let everything that is compiled or loaded at its first use be so now: no step of a flight may wait for it.

    The estimators see to their own kernels when they are made.

    Args:
        guidance: law that is flown.
        config: all numbers.
    """
    cdr.load()
    offset_s = np.arange(0.0, 4.01, 0.2)
    ahead = np.column_stack([30.0 + 8.0 * offset_s, 2.0 * offset_s, np.full_like(offset_s, 2.0)])
    zero = np.zeros(3)
    state = ReferenceState(position_enu_m=zero, velocity_enu_m_s=zero, acceleration_enu_m_s2=zero)
    memory: GuidanceMemory | None = None
    for position in (ahead, ahead - ahead[0]):
        target = Target(
            offset_s=offset_s,
            position_enu_m=position,
            velocity_enu_m_s=np.tile([8.0, 2.0, 0.0], (len(offset_s), 1)),
            acceleration_enu_m_s2=np.zeros((len(offset_s), 3)),
        )
        request = PlanRequest(
            state=state,
            target=target,
            limits=config.limits.flight_limits(),
            floor_enu_m=np.zeros_like(offset_s),
            dt_s=1.0 / config.setpoints.rate_hz,
        )
        memory, _ = guidance.plan(memory, request)
    _compile_pad_motion(offset_s)
    _compile_descent(offset_s, config)
    compile_rollout()


def _compile_pad_motion(offset_s: Array) -> None:
    still, level, tilt = np.zeros_like(offset_s), (1.0, 0.1, 1.0), np.zeros((len(offset_s), 4))
    turned_lever(still, still, offset_s, 1.0, 0.0)
    tilted_lever(still, tilt, 1.0, 0.0, 1.0)
    yaw_rate(still, offset_s)
    tilted_deck(still, tilt, level, level)


def _compile_descent(offset_s: Array, config: CompanionConfig) -> None:
    way_down((2.0, -0.5, 0.0), offset_s, config.limits.flight_limits(), config.descent)
    lean_change((0.0, 0.0), (0.0, 0.0), (0.0, 0.0), 1.0, 1.0)


def build_node(
    config: CompanionConfig,
    keys: Keys,
    *,
    system_id: int = 1,
    dry_run: bool = False,
    publishes: bool = True,
    is_component: bool = False,
    records_input: bool = False,
    recorder: Recorder | None = None,
    signing: Signing | None = None,
    first_number: int = 0,
) -> CompanionNode:
    """Return a companion that has seen nothing yet.

    Args:
        config: all its numbers.
        keys: of the Zenoh contract.
        system_id: MAVLink's, of the autopilot that is flown and, on the same drone, of the companion.
        dry_run: send neither setpoints nor commands.
        publishes: put status and plan on Zenoh.
        is_component: hear and tell ground stations, too.
        records_input: keep received frames for a recording of the link.
        recorder: takes all that goes in and out, None where nothing is recorded.
        signing: by a key shared with the autopilot; None sends unsigned and takes everything.
        first_number: of MAVLink's sequence.

    Raises:
        UserError: what the configuration chooses is not installed.
    """
    _check_installed(config)
    system = System(
        config=config,
        estimator=make_estimator(config.estimator, is_silent=config.silent_vehicle is not None),
        guidance=make_guidance(config.guidance.kind, config.guidance),
    )
    warm_up(system.guidance, config)
    session = MavlinkSession(
        system_id,
        target_system_id=system_id,
        signing=signing,
        records_input=records_input,
        first_number=first_number,
        takes_own_utc=config.autopilot.utc is UtcOf.COMPUTER,
    )
    if recorder is not None:
        return RecordingNode(
            system, keys, session, recorder, dry_run=dry_run, publishes=publishes, is_component=is_component
        )
    return CompanionNode(system, keys, session, dry_run=dry_run, publishes=publishes, is_component=is_component)


def _check_installed(config: CompanionConfig) -> None:
    if config.estimator.kind is not EstimatorKind.IMM:
        require("sim", f"estimator.kind = {config.estimator.kind.value!r}")
    if config.guidance.mpc.solver is SolverKind.OSQP:
        require("sim", f"guidance.mpc.solver = {SolverKind.OSQP.value!r}")


def make_guidance(kind: GuidanceKind, config: GuidanceConfig) -> Guidance:
    """Return the guidance law `kind` with its numbers from `config`."""
    return cast("Guidance", _law(kind, config))  # each has its own memory, which only it reads


def _law(kind: GuidanceKind, config: GuidanceConfig) -> Mpc | ReportMpc | ProportionalNavigation:
    match kind:
        case GuidanceKind.MPC:
            return Mpc(config.mpc)
        case GuidanceKind.MPC_REPORT:
            return ReportMpc(config.mpc_report)
        case GuidanceKind.PN:
            return ProportionalNavigation(config.pn)
        case _:
            assert_never(kind)
