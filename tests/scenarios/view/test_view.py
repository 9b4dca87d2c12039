"""The view without a browser: its shapes, what it makes of messages, and what its command refuses."""

import math
from html import escape

import numpy as np
import pytest
from typer.testing import CliRunner

from link.errors import UserError
from link.frames.rotations import quaternion_from_roll_pitch_yaw, rotate
from link.messages import BodyTruth, LandingStatus, PadGeometry, Vector3
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.payloads.decklander_msgs import floats, ros_message
from link.records import replace
from link.zenoh.keys import Keys
from scenarios.app import app
from scenarios.tracks.roads import road_of
from scenarios.view.history import NAMES, History
from scenarios.view.marks import drone_label
from scenarios.view.panel_text import known_text
from scenarios.view.plots import with_cursor
from scenarios.view.shapes import box_edges, centre_line, cone, ellipses, estimated_vehicle, polyline, ribbon
from scenarios.view.state import Estimate, ForecastPath, StateReader, ViewState

KEYS = Keys()
PAD = PadGeometry(size_m=(1.5, 1.2), height_m=1.4, antenna_to_pad_m=(1.2, -0.5, -0.1))
STILL: Vector3 = (0.0, 0.0, 0.0)


def drone_at(t_ns: int, height_m: float = 3.0) -> BodyTruth:
    return BodyTruth(
        t_ns=t_ns,
        position_enu_m=(1.0, 2.0, height_m),
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        velocity_flu_m_s=(3.0, 0.0, 4.0),
        angular_velocity_flu_rad_s=STILL,
    )


def status_with(*, armed: bool) -> LandingStatus:
    return LandingStatus(
        stamp_ns=5,
        phase="chase",
        reason="",
        relative_position_enu_m=(3.0, -4.0, 1.0),
        relative_velocity_enu_m_s=None,
        height_above_pad_m=1.0,
        time_to_contact_s=None,
        armed=armed,
        fix_age_s=None,
    )


def test_label_of_a_drone_beside_the_pad_does_not_say_that_it_is_above_it() -> None:
    beside = status_with(armed=True)
    assert drone_label(beside) == "drone 1.0 m higher, 5 m away"
    assert drone_label(replace(beside, relative_position_enu_m=(0.3, -0.4, 1.0))) == "drone 1.0 m above the pad"


def test_estimated_vehicle_stands_where_its_antenna_says() -> None:
    turned = quaternion_from_roll_pitch_yaw(0.0, 0.0, 0.7)
    road_point = np.array([10.0, -20.0, 0.3])
    antenna = road_point + rotate(turned, (-1.2, 0.5, 1.5))
    estimate = Estimate(t_ns=0, position_enu_m=antenna, velocity_enu_m_s=np.zeros(3), yaw_rad=0.7)
    pose = estimated_vehicle(ViewState(estimate=estimate, pad=PAD))
    assert pose is not None
    assert pose[0] == pytest.approx(tuple(road_point))
    assert pose[1] == pytest.approx(turned)


def test_estimated_vehicle_without_a_heading_points_along_its_course_or_nowhere() -> None:
    def pose(velocity: tuple[float, float, float]) -> object:
        estimate = Estimate(t_ns=0, position_enu_m=np.zeros(3), velocity_enu_m_s=np.array(velocity), yaw_rad=None)
        return estimated_vehicle(ViewState(estimate=estimate, pad=PAD))

    driving = pose((-1.0, 2.0, 0.0))
    assert isinstance(driving, tuple)
    assert rotate(driving[1], (math.sqrt(5.0), 0.0, 0.0)) == pytest.approx((-1.0, 2.0, 0.0))
    assert pose((0.1, 0.0, 0.0)) is None


def test_estimate_is_carried_on_to_the_time_that_is_shown() -> None:
    estimate = Estimate(
        t_ns=1_000_000_000, position_enu_m=np.zeros(3), velocity_enu_m_s=np.array([6.0, 0.0, 0.0]), yaw_rad=0.0
    )
    poses = [estimated_vehicle(ViewState(t_ns=t_ns, estimate=estimate, pad=PAD)) for t_ns in (10**9, 11 * 10**8)]
    assert poses[0] is not None
    assert poses[1] is not None
    assert poses[1][0][0] - poses[0][0][0] == pytest.approx(0.6)


def test_ellipses_lie_at_the_stated_deviations() -> None:
    std_m = np.tile([2.0, 0.5, 9.0], (6, 1))
    centres = np.arange(18.0).reshape(6, 3)
    drawn = ellipses(ForecastPath(position_enu_m=centres, std_m=std_m), 2.0)
    first = drawn[: len(drawn) // 2, 0] - centres[0]
    assert np.allclose((first[:, 0] / 4.0) ** 2 + (first[:, 1] / 1.0) ** 2, 1.0)
    assert np.all(first[:, 2] == 0.0)


def test_box_has_twelve_edges_along_its_axes() -> None:
    edges = box_edges((4.0, 2.0, 1.5))
    lengths = sorted(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1))
    assert lengths == [1.5] * 4 + [2.0] * 4 + [4.0] * 4


def test_ribbon_is_as_wide_as_asked_for_all_along_the_road() -> None:
    line = centre_line(road_of([(30.0, 0.0), (40.0, 0.05)], heading_rad=0.4))
    vertices, faces = ribbon(line, 4.5)
    assert np.allclose(np.linalg.norm(vertices[0::2] - vertices[1::2], axis=1), 4.5)
    assert faces.min() == 0
    assert faces.max() == len(vertices) - 1
    assert len(polyline(line)) == len(line) - 1


def test_cone_widens_from_the_pad_by_its_slope() -> None:
    vertices, _ = cone(0.3, 0.35, 3.0)
    radii = np.hypot(vertices[:, 0], vertices[:, 1])
    assert np.allclose(radii, 0.3 + 0.35 * vertices[:, 2])


@pytest.mark.parametrize("topic", sorted(StateReader(KEYS).topics))
def test_bytes_that_are_no_message_are_refused_and_change_nothing(topic: str) -> None:
    state = ViewState(pad=PAD)
    with pytest.raises(PayloadError):
        StateReader(KEYS).taken(state, topic, b"\x00\x01\x00\x00\xff")
    assert state.pad == PAD


def test_plan_is_forgotten_when_the_motors_are_off() -> None:
    reader, flown = StateReader(KEYS), ViewState(plan_enu_m=np.zeros((2, 3)))
    on, off = (json_messages.encode(status_with(armed=armed)) for armed in (True, False))
    assert reader.taken(flown, KEYS.landing_status, on).plan_enu_m is not None
    assert reader.taken(flown, KEYS.landing_status, off).plan_enu_m is None


def test_history_has_each_instant_once_and_begins_anew_with_a_new_run() -> None:
    history = History()
    for t_ns in (10_000_000_000, 10_000_000_000, 12_000_000_000):
        history.add(ViewState(t_ns=t_ns, drone_truth=drone_at(t_ns), status=status_with(armed=True)))
    assert history.times_s == [0.0, 2.0]
    row = dict(zip(NAMES, history.values[-1], strict=True))
    assert (row["distance_m"], row["height_m"], row["drone_speed_m_s"]) == (5.0, 1.0, 5.0)
    history.add(ViewState(t_ns=5_000_000_000, drone_truth=drone_at(5_000_000_000)))
    assert history.times_s == [0.0]


def test_trail_leaves_out_what_is_unknown() -> None:
    history = History()
    history.add(ViewState(t_ns=1_000_000_000))
    history.add(ViewState(t_ns=2_000_000_000, drone_truth=drone_at(2_000_000_000)))
    assert history.trail(history.drone, 2, 10, 1).tolist() == [[1.0, 2.0, 3.0]]
    assert history.trail(history.pad, 2, 10, 1).shape == (0, 3)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["view", "/there/is/none"], "no such folder"),
        (["run", "straight_5", "--lockstep", "--view"], "leave out --view"),
    ],
)
def test_command_refuses_what_cannot_be_shown(arguments: list[str], told: str) -> None:
    result = CliRunner().invoke(app, arguments)
    assert isinstance(result.exception, UserError)
    assert told in str(result.exception)


def test_cursor_steps_at_its_instant_within_the_range_and_bends_no_curve() -> None:
    times_s, values = np.array([0.0, 1.0, 2.0, 4.0]), np.array([1.0, 3.0, 2.0, -1.0])
    at_s, curve, cursor = with_cursor((times_s, values), 3.0)
    assert np.all(np.diff(at_s) > 0.0)
    assert np.allclose(curve, np.interp(at_s, times_s, values))
    assert (cursor.min(), cursor.max()) == (-1.0, 3.0)
    assert at_s[np.flatnonzero(np.diff(cursor))[0]] == pytest.approx(3.0)


@pytest.mark.parametrize("now_s", [-5.0, 0.0, 4.0, math.inf])
def test_cursor_outside_of_what_is_known_is_at_its_edge(now_s: float) -> None:
    at_s, _, cursor = with_cursor((np.array([0.0, 4.0]), np.array([1.0, 2.0])), now_s)
    assert at_s[0] >= 0.0
    assert at_s[-1] == pytest.approx(4.0)
    assert cursor[-1] == 2.0


def test_panel_tells_attitude_in_degrees_and_the_heading_by_compass() -> None:
    turned = quaternion_from_roll_pitch_yaw(math.radians(10.0), math.radians(-5.0), math.radians(60.0))
    text = known_text(ViewState(own=replace(drone_at(1), orientation_wxyz=turned)), 0.0)
    assert "10° right, 5° nose up" in text
    assert "030° from north" in text


def test_panel_of_a_recording_tells_the_forecast_of_the_contact_while_it_is_fresh() -> None:
    status = replace(status_with(armed=True), stamp_ns=7_000_000_000)
    chances = {"s1": 0.99, "s2": 0.9, "unsafe": 0.01, "broken_off": 0.0}
    misses = {"misses_position": 0.01, "misses_speed": 0.0, "misses_sink": 0.0, "misses_tilt": 0.0}
    name = KEYS.record("contact_forecast")
    message = ros_message(name, "ContactForecast", status.stamp_ns, in_s=floats(1.5), **chances, **misses)
    state = StateReader(KEYS).taken(ViewState(status=status), message.topic, message.payload)
    assert "90 % S2, 1.0 % unsafe" in known_text(state, 0.0)
    late = replace(status, stamp_ns=status.stamp_ns + 1_000_000_000)
    assert "unsafe" not in known_text(replace(state, status=late), 0.0)


def test_panel_gives_a_sentence_both_columns_and_breaks_no_number() -> None:
    sentence = "the vehicle's stamps: those that are 0.1 s late shift the pad by 0.1 m for each m/s"
    text = known_text(ViewState(status=replace(status_with(armed=True), unverified=(sentence,))), 0.0)
    assert f'<td colspan="2"><span style="color:#667">not verified</span>: {escape(sentence)}</td>' in text
    assert 'white-space:nowrap">armed</td>' in text
