"""The estimates' errors: whose times a report of the drone may have."""

from link.messages import BodyTruth
from scenarios.reports.estimate_track import reported


def report(t_ns: int, east_m: float) -> BodyTruth:
    return BodyTruth(
        t_ns=t_ns,
        position_enu_m=(east_m, 0.0, 0.0),
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        velocity_flu_m_s=(0.0, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


def test_reports_from_outside_of_the_run_do_not_count_and_the_others_are_in_order() -> None:
    second = 1_000_000_000
    reports = [report(10 * second, 1.0), report(90 * second, 7.0), report(12 * second, 3.0), report(11 * second, 2.0)]
    times_s, positions_m = reported(reports, 10 * second, 20 * second)
    assert times_s.tolist() == [0.0, 1.0, 2.0]
    assert positions_m[:, 0].tolist() == [1.0, 2.0, 3.0]
