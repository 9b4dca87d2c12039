import pytest

from companion.config.planning import GuidanceConfig, GuidanceKind
from companion.planning.guidance import PlanStatus
from companion.planning.mpc import Mpc
from companion.planning.mpc_report import ReportMpc
from companion.planning.pn import ProportionalNavigation
from companion.runtime.build import make_guidance
from tests.companion.planning.cases import request_of, state_at, straight, target_of


@pytest.mark.parametrize(
    ("kind", "law"),
    [
        (GuidanceKind.MPC, Mpc),
        (GuidanceKind.MPC_REPORT, ReportMpc),
        (GuidanceKind.PN, ProportionalNavigation),
    ],
)
def test_each_kind_makes_its_law(kind: GuidanceKind, law: type) -> None:
    assert isinstance(make_guidance(kind, GuidanceConfig()), law)


@pytest.mark.parametrize("kind", GuidanceKind)
def test_every_law_plans_from_no_memory(kind: GuidanceKind) -> None:
    request = request_of(state_at((0.0, 0.0, 5.0)), target_of(straight((4.0, 3.0, 1.0), (2.0, 0.0, 0.0))))
    _, result = make_guidance(kind, GuidanceConfig()).plan(None, request)
    assert result.status is PlanStatus.SOLVED
    assert result.trajectory.position_enu_m.shape == (len(result.trajectory.offset_s), 3)
