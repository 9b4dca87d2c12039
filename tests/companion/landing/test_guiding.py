"""Guidance only: the autopilot is told where the pad is, and nothing is flown."""

import pytest

from companion.config.autopilot import Guide
from companion.config.companion import CompanionConfig
from companion.situation.phases import Phase
from link.messages import Command, PadGeometry
from tests.companion.peer import Setup

PAD = PadGeometry(size_m=(1.5, 1.5), height_m=1.5, antenna_to_pad_m=(0.0, 0.0, 0.0))
PLACE = (-30.0, 40.0, 1.5)


def _guiding(guide: Guide = Guide.PRECLAND, *, dry_run: bool = False) -> Setup:
    table = {"autopilot": {"guide": guide}, "integrity": {"receiver_frames": "one"}}
    config = CompanionConfig.model_validate(table, strict=False)
    setup = Setup(config=config, dry_run=dry_run)
    setup.node.receive_pad(PAD)
    setup.run(3.0)
    return setup


@pytest.mark.slow
def test_pad_is_told_at_the_step_rate_and_no_longer_than_it_is_known() -> None:
    setup = _guiding()
    assert setup.autopilot.of_type("LANDING_TARGET") == []
    setup.run(3.0, lambda: setup.fixes(PLACE, std_m=0.02))
    told = setup.autopilot.of_type("LANDING_TARGET")
    before = len(told)
    assert (told[-1].y, told[-1].x) == pytest.approx(PLACE[:2], abs=0.2)
    setup.run(1.0, lambda: setup.fixes(PLACE, std_m=0.02))
    assert 40 <= len(setup.autopilot.of_type("LANDING_TARGET")) - before <= 70
    setup.run(3.0)
    silent = len(setup.autopilot.of_type("LANDING_TARGET"))
    setup.run(1.0)
    assert len(setup.autopilot.of_type("LANDING_TARGET")) == silent


def test_start_is_refused_and_nothing_is_flown() -> None:
    setup = _guiding()
    setup.node.request(Command.START)
    setup.run(1.0, lambda: setup.fixes(PLACE, std_m=0.02))
    (reply,) = setup.node.take_replies()
    assert not reply.accepted
    assert "precision landing" in reply.reason
    assert setup.node.phase is Phase.IDLE
    assert setup.autopilot.setpoints() == []
    assert not setup.autopilot.armed


@pytest.mark.parametrize(("guide", "dry_run"), [(Guide.SETPOINTS, False), (Guide.PRECLAND, True)])
def test_pad_is_not_told_unless_asked_to(guide: Guide, *, dry_run: bool) -> None:
    setup = _guiding(guide, dry_run=dry_run)
    setup.run(2.0, lambda: setup.fixes(PLACE, std_m=0.02))
    assert setup.autopilot.of_type("LANDING_TARGET") == []
