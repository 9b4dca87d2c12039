"""The landing's status: every field from the facts, None where nothing is known, and always fit to be sent."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from companion.core.reasons import Cause, Reason
from companion.landing.outputs import landing_status
from companion.landing.state.memory import StepMemory
from companion.situation.phases import Phase
from link.messages import LandingStatus
from link.payloads import json_messages as json_payloads
from link.records import replace
from tests.companion.facts import CONFIG, changed, drone_at, pad_at, situation

MEMORY = changed(StepMemory(), phase=Phase.DESCEND, cause=Cause(Reason.ALIGNED))


def test_fields_are_the_drone_against_the_pad() -> None:
    pad = pad_at()
    facts = replace(situation(), drone=drone_at(1.2, 0.4, (0.1, -0.2, -0.7), pad=pad), pad=pad)
    status = landing_status(MEMORY, facts, CONFIG)
    assert (status.phase, status.reason, status.stamp_ns) == ("descend", "aligned", facts.t_ns)
    assert status.relative_position_enu_m == pytest.approx((0.4, 0.0, 1.2))
    assert status.relative_velocity_enu_m_s == pytest.approx((0.1, -0.2, -0.7))
    assert status.height_above_pad_m == pytest.approx(1.2)
    assert status.armed
    assert status.fix_age_s == pytest.approx(0.1)


def test_unknown_is_none() -> None:
    facts = changed(situation(), drone=None, fix_age_s=None)
    status = landing_status(MEMORY, facts, CONFIG)
    assert status.relative_position_enu_m is None
    assert status.relative_velocity_enu_m_s is None
    assert status.height_above_pad_m is None
    assert status.time_to_contact_s is None
    assert status.fix_age_s is None


@pytest.mark.parametrize("height_m", [2.7, 1.3, 0.6, 0.2])
def test_time_to_contact_of_a_drone_that_sinks_as_wanted_is_that_of_the_sink_profile(height_m: float) -> None:
    descent, pad = CONFIG.descent, pad_at()

    def rate(_: float, h: np.ndarray) -> list[float]:
        wanted = descent.sink.gain_hz * h[0]
        return [-min(max(wanted, descent.sink.contact_rate_m_s), descent.sink.rate_max_m_s)]

    def contact(_: float, h: np.ndarray) -> float:
        return float(h[0])

    contact.terminal = True  # type: ignore[attr-defined]  # as scipy wants it
    truth = solve_ivp(rate, (0.0, 20.0), [height_m], events=contact, max_step=1e-2)
    sinking = drone_at(height_m, 0.0, (0.0, 0.0, rate(0.0, np.array([height_m]))[0]), pad=pad)
    status = landing_status(MEMORY, replace(situation(), drone=sinking, pad=pad), CONFIG)
    assert status.time_to_contact_s == pytest.approx(truth.t[-1], rel=0.03)


def test_time_to_contact_of_a_drone_that_does_not_sink_yet_is_longer_and_with_little_jerk_longer_still() -> None:
    sinking, hovering = (
        replace(situation(), drone=drone_at(1.5, 0.0, (0.0, 0.0, rate_m_s), pad=pad_at()), pad=pad_at())
        for rate_m_s in (-1.2, 0.0)
    )
    smooth = replace(hovering, limits=replace(CONFIG.limits.flight_limits(), vertical_jerk_max_m_s3=4.0))
    times_s = [landing_status(MEMORY, one, CONFIG).time_to_contact_s or 0.0 for one in (sinking, hovering, smooth)]
    assert times_s[0] + 0.3 < times_s[1] < times_s[2] - 0.05


def test_time_to_contact_is_zero_on_the_pad_and_told_while_descending_only() -> None:
    assert landing_status(MEMORY, situation(-0.1), CONFIG).time_to_contact_s == 0.0
    for phase in Phase:
        timed = landing_status(changed(MEMORY, phase=phase), situation(), CONFIG).time_to_contact_s is not None
        assert timed == (phase in {Phase.ALIGN, Phase.DESCEND})


@pytest.mark.parametrize("phase", [Phase.WAITING, Phase.CHASE, Phase.ALIGN])
def test_unknown_heading_is_named_as_what_the_landing_waits_for(phase: Phase) -> None:
    facts = situation(pad=pad_at(placed=False))
    assert landing_status(changed(MEMORY, phase=phase), facts, CONFIG).reason == "vehicle heading unknown"


def test_status_of_every_phase_passes_its_own_schema() -> None:
    for phase in Phase:
        for facts in (situation(), replace(situation(), drone=None), changed(situation(), pad=None, fix_age_s=None)):
            status = landing_status(changed(MEMORY, phase=phase), facts, CONFIG)
            assert json_payloads.decode(LandingStatus, json_payloads.encode(status)) == status
