"""Making the guidance law that a configuration names."""

from typing import assert_never, cast

from companion.config.planning import GuidanceConfig, GuidanceKind
from companion.planning.guidance import Guidance
from companion.planning.mpc import Mpc
from companion.planning.mpc_report import ReportMpc
from companion.planning.pn import ProportionalNavigation


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
