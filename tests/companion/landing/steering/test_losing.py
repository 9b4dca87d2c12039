"""For how long a drone has lost its model: one that swings about its setpoints heeds them, one that flies on not."""

import numpy as np
import pytest

from companion.landing.steering.losing import LOST_FOR_S, Losses, add_loss, lost_for_s

PERIOD_S = 0.5
SPEEDS_UP_M_S2 = 2.5  # what a car does for seconds
SWINGS_M_S = 0.6


def ns(t_s: float) -> int:
    return round(t_s * 1e9)


def lose(losses: Losses | None, from_s: float, until_s: float, *, share: float, swings_m_s: float = 0.0) -> Losses:
    """A drone that makes this share of what its plans ask for, an acceleration from 5 m/s on; lost twice a second."""
    for t_s in np.arange(from_s, until_s, PERIOD_S).tolist():
        velocity_m_s = np.array([5.0 + share * SPEEDS_UP_M_S2 * t_s, 0.0])
        left_out_m_s = (1.0 - share) * SPEEDS_UP_M_S2 * PERIOD_S
        losses = add_loss(losses, ns(t_s), velocity_m_s, np.array([-left_out_m_s - swings_m_s, 0.0]))
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
    assert add_loss(losses, ns(3.1), np.array([5.0, 0.0]), np.zeros(2)).since_ns == ns(3.1)


@pytest.mark.parametrize(("share", "heeds"), [(0.0, False), (0.3, False), (0.7, True), (1.0, True)])
def test_drone_that_makes_most_of_what_is_asked_for_heeds_its_setpoints(share: float, heeds: bool) -> None:
    losses = lose(None, 0.0, 2.4, share=share)
    assert (lost_for_s(losses, ns(2.4)) == 0.0) is heeds


def test_drone_that_swings_about_its_setpoints_as_it_speeds_up_heeds_them() -> None:
    for until_s in np.arange(1.1, 20.0, PERIOD_S).tolist():
        losses = lose(None, 0.0, until_s, share=1.0, swings_m_s=SWINGS_M_S)
        assert lost_for_s(losses, ns(until_s)) < LOST_FOR_S


def test_drone_that_stops_beside_a_steady_vehicle_does_not_heed_them() -> None:
    """Each plan begins at the drone, and speeds up to the vehicle's 5 m/s."""
    losses: Losses | None = None
    for t_s in np.arange(0.0, 9.1, PERIOD_S).tolist():
        velocity_m_s = max(5.0 - 4.0 * t_s, 0.0)
        left_out_m_s = 4.0 * PERIOD_S if velocity_m_s > 0.0 else SPEEDS_UP_M_S2 * PERIOD_S
        losses = add_loss(losses, ns(t_s), np.array([velocity_m_s, 0.0]), np.array([-left_out_m_s, 0.0]))
        assert lost_for_s(losses, ns(t_s)) == pytest.approx(t_s)


def test_drone_that_heeded_them_for_long_and_does_no_more_is_found_as_soon() -> None:
    losses, found_s = lose(None, 0.0, 20.1, share=1.0, swings_m_s=SWINGS_M_S), None
    even_m_s = np.array([5.0 + 20.0 * SPEEDS_UP_M_S2, 0.0])
    for t_s in np.arange(PERIOD_S, 6.1, PERIOD_S).tolist():
        losses = add_loss(losses, ns(20.0 + t_s), even_m_s, np.array([-SPEEDS_UP_M_S2 * PERIOD_S, 0.0]))
        if found_s is None and lost_for_s(losses, ns(20.0 + t_s)) > LOST_FOR_S:
            found_s = t_s
    assert found_s is not None
    assert found_s <= 2.0 * LOST_FOR_S
