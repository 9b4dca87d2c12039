"""For how long a drone has lost its model: one that swings about its setpoints heeds them, one that flies on not."""

import numpy as np
import pytest

from companion.landing.steering.losing import LOST_FOR_S, Losses, add_loss, lost_for_s, move_losses
from companion.planning.guidance import ReferenceState

PERIOD_S = 0.5
SPEEDS_UP_M_S2 = 2.5  # what a car does for seconds
SWINGS_M = 0.5


def drone(x_m: float, speed_m_s: float) -> ReferenceState:
    return ReferenceState(
        position_enu_m=np.array([x_m, 1.0, 4.0]),
        velocity_enu_m_s=np.array([speed_m_s, 0.0, 0.0]),
        acceleration_enu_m_s2=np.zeros(3),
    )


def ns(t_s: float) -> int:
    return round(t_s * 1e9)


def lose(losses: Losses | None, from_s: float, until_s: float, *, share: float, swings_m: float = 0.0) -> Losses:
    """A drone that makes this share of what its plans ask for, an acceleration from 5 m/s on; lost twice a second."""
    for t_s in np.arange(from_s, until_s, PERIOD_S).tolist():
        made_m_s2 = share * SPEEDS_UP_M_S2
        state = drone((5.0 + 0.5 * made_m_s2 * t_s) * t_s, 5.0 + made_m_s2 * t_s)
        late_s = max(t_s - PERIOD_S, 0.0)
        left_out_m = 0.5 * (1.0 - share) * SPEEDS_UP_M_S2 * (t_s**2 - late_s**2)
        losses = add_loss(losses, ns(t_s), state, np.array([-left_out_m - swings_m, 0.0]))
    assert losses is not None
    return losses


def test_drone_that_is_lost_once_has_been_lost_since() -> None:
    losses = lose(None, 0.0, PERIOD_S, share=1.0)
    assert lost_for_s(None, 0) == 0.0
    assert lost_for_s(losses, ns(0.9)) == pytest.approx(0.9)


def test_drone_that_has_followed_for_a_second_has_lost_nothing() -> None:
    losses = lose(None, 0.0, 2.1, share=0.0)
    assert lost_for_s(losses, ns(2.9)) == pytest.approx(2.9)
    assert lost_for_s(losses, ns(3.1)) == 0.0
    assert add_loss(losses, ns(3.1), drone(20.0, 5.0), np.zeros(2)).since_ns == ns(3.1)


@pytest.mark.parametrize(("share", "heeds"), [(0.0, False), (0.3, False), (0.7, True), (1.0, True)])
def test_drone_that_makes_most_of_what_is_asked_for_heeds_its_setpoints(share: float, heeds: bool) -> None:
    losses = lose(None, 0.0, 2.6, share=share)
    assert (lost_for_s(losses, ns(2.6)) == 0.0) is heeds


def test_drone_that_swings_about_its_setpoints_as_it_speeds_up_heeds_them() -> None:
    for until_s in np.arange(1.1, 20.0, PERIOD_S).tolist():
        losses = lose(None, 0.0, until_s, share=1.0, swings_m=SWINGS_M)
        assert lost_for_s(losses, ns(until_s)) < LOST_FOR_S


def test_drone_beside_a_steady_vehicle_that_stops_does_not_heed_them() -> None:
    losses: Losses | None = None
    for t_s in np.arange(0.0, 2.6, PERIOD_S).tolist():
        losses = add_loss(losses, ns(t_s), drone(0.0, 0.0), np.array([-5.0 * PERIOD_S, 0.0]))
    assert lost_for_s(losses, ns(2.6)) == pytest.approx(2.6)


def test_drone_that_heeded_them_for_long_and_does_no_more_is_found_as_soon() -> None:
    heeded = lose(None, 0.0, 20.1, share=1.0, swings_m=SWINGS_M)
    speed_m_s, x_m = 5.0 + 20.0 * SPEEDS_UP_M_S2, (5.0 + 0.5 * 20.0 * SPEEDS_UP_M_S2) * 20.0
    losses, found_s = heeded, None
    for t_s in np.arange(PERIOD_S, 6.1, PERIOD_S).tolist():
        left_out_m = 0.5 * SPEEDS_UP_M_S2 * (t_s**2 - (t_s - PERIOD_S) ** 2)
        state = drone(x_m + speed_m_s * t_s, speed_m_s)
        losses = add_loss(losses, ns(20.0 + t_s), state, np.array([-left_out_m, 0.0]))
        if found_s is None and lost_for_s(losses, ns(20.0 + t_s)) > LOST_FOR_S:
            found_s = t_s
    assert found_s is not None
    assert found_s <= 2.0 * LOST_FOR_S


def test_frame_that_moves_moves_what_is_kept() -> None:
    losses = lose(None, 0.0, PERIOD_S, share=1.0)
    moved = move_losses(losses, np.array([3.0, -2.0, 1.0]))
    assert moved is not None
    np.testing.assert_allclose(moved.place_enu_m - losses.place_enu_m, [3.0, -2.0])
    assert move_losses(None, np.zeros(3)) is None
