import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.eyes.attitude import GAP_MAX_NS, Attitude, attitude_at, with_attitude
from companion.eyes.board import load_board, nested_board
from companion.eyes.camera import matrix_of
from companion.eyes.mounting import angles_of
from companion.eyes.node import EyesNode
from companion.eyes.picture import WholePicture
from companion.eyes.sources.frames import Captured, gray_of_file
from link.errors import UserError
from link.frames.rotations import quaternion_from_yaw, yaw_of
from link.messages import BodyTruth, CompressedPicture, PadGeometry, PadSighting
from link.payloads import cdr
from link.records import replace
from link.zenoh.keys import Keys
from tests.companion.eyes.frames import MOUNTING, Case, case, system

KEYS = Keys()
BOARD = load_board(None).config
FAR_M = 7.0
"""Where fewer of the board's markers are large enough to be measured, in half the time."""


def captured(one: Case) -> Captured:
    assert isinstance(one.frame.picture, WholePicture)
    return Captured(t_ns=one.frame.t_ns, shades=one.frame.picture.shades)


def own(one: Case) -> bytes:
    """The drone's state as the companion tells it."""
    attitude = one.frame.orientation_wxyz
    assert attitude is not None
    still = (0.0, 0.0, 0.0)
    return cdr.encode(
        BodyTruth(
            t_ns=one.frame.t_ns,
            position_enu_m=still,
            orientation_wxyz=attitude,
            velocity_flu_m_s=still,
            angular_velocity_flu_rad_s=still,
        )
    )


@pytest.mark.slow
def test_a_frame_brings_the_sighting_that_the_companion_reads() -> None:
    one = case(4.0, board=BOARD)
    node = EyesNode(system(), KEYS)
    node.receive_own(own(one))
    (published,) = node.look(captured(one), shows=False)
    assert (published.key, published.encoding) == (KEYS.pad_pose, cdr.encoding_of(PadSighting))
    sighting = cdr.decode(PadSighting, published.payload)
    assert sighting.t_ns == one.frame.t_ns
    assert sighting.position_flu_m == pytest.approx(one.away_flu_m.tolist(), abs=0.05)
    assert node.take_news() == ["pad seen"]
    assert (node.counts.frames, node.counts.seen) == (1, 1)


@pytest.mark.slow
def test_a_frame_without_the_pad_brings_nothing_but_news() -> None:
    node = EyesNode(system(), KEYS)
    node.look(captured(case(4.0, board=BOARD)), shows=False)
    node.take_news()
    assert node.look(captured(case(4.0, board=None, t_ns=1_033_000_000)), shows=False) == []
    assert node.take_news() == ["pad lost"]


@pytest.mark.slow
def test_ids_of_another_board_are_told_once() -> None:
    node = EyesNode(system(), KEYS)
    frame = captured(case(4.0, board=nested_board(1.5, 63)))
    node.look(frame, shows=False)
    node.look(frame, shows=False)
    (line,) = node.take_news()
    assert "not on the board" in line


def test_what_is_shown_is_the_frame_in_colours() -> None:
    one = case(4.0, board=BOARD)
    shown = EyesNode(system(), KEYS).look(captured(one), shows=True)[-1]
    assert shown.key == KEYS.pad_view
    picture = cdr.decode(CompressedPicture, shown.payload)
    assert gray_of_file(picture).shape == captured(one).shades.shape


def test_frames_of_another_size_than_the_calibrations_are_an_error() -> None:
    small = captured(case(4.0, board=BOARD)).shades[:480, :640]
    with pytest.raises(UserError, match="640 x 480"):
        EyesNode(system(), KEYS).look(Captured(t_ns=1, shades=small), shows=False)


def test_later_frame_of_another_size_is_somebody_elses_and_told_once() -> None:
    one = captured(case(4.0, board=BOARD))
    node = EyesNode(system(), KEYS)
    assert node.look(one, shows=False)
    for _ in range(2):
        assert node.look(Captured(t_ns=one.t_ns, shades=one.shades[:480, :640]), shows=True) == []
    assert [line for line in node.take_news() if "640 x 480" in line] == [
        "pictures of 640 x 480 pixels are passed over: the calibration is for {} x {}".format(*one.size_px)
    ]
    assert node.look(one, shows=False)


@pytest.mark.parametrize("t_ns", [0, 20_261_128_075_437_123_456], ids=["never filled in", "too late"])
def test_picture_without_a_time_ends_nothing_and_is_told_once(t_ns: int) -> None:
    one = captured(case(4.0, board=BOARD, aside_m=(0.0, -1.0)))
    node = EyesNode(replace(system(), mounting=replace(MOUNTING, readout_s=0.03)), KEYS)
    for _ in range(2):
        assert node.look(replace(one, t_ns=t_ns), shows=True) == []
    (told,) = node.take_news()
    assert told.startswith("pictures without a time are passed over")
    assert node.look(one, shows=False)


def test_pad_that_does_not_fit_is_told_and_ends_nothing_once_the_board_has_been_seen() -> None:
    node = EyesNode(system(), KEYS)
    node.look(captured(case(4.0, board=BOARD)), shows=False)
    node.receive_pad(PadGeometry(size_m=(0.5, 0.5), height_m=1.5, antenna_to_pad_m=(0.0, 0.0, 0.0)))
    assert [line for line in node.take_news() if "the vehicle's pad 0.5 x 0.5 m" in line]
    assert node.look(captured(case(4.0, board=BOARD)), shows=False)


def test_attitudes_are_kept_where_one_is_told_twice_and_not_where_the_clock_is_set_back() -> None:
    history: tuple[Attitude, ...] = ()
    for t_ns in (10, 20, 20, 30, 30):
        history = with_attitude(history, Attitude(t_ns=t_ns, orientation_wxyz=quaternion_from_yaw(0.01 * t_ns)))
    assert [one.t_ns for one in history] == [10, 20, 30]
    back = Attitude(t_ns=29, orientation_wxyz=quaternion_from_yaw(0.0))
    assert with_attitude(history, back) == (back,)


@pytest.mark.parametrize(("size_m", "fits"), [((1.5, 1.5), True), ((2.0, 3.0), True), ((1.5, 1.2), False)])
def test_a_board_that_is_larger_than_the_vehicles_pad_is_an_error(size_m: tuple[float, float], fits: bool) -> None:
    pad = PadGeometry(size_m=size_m, height_m=1.5, antenna_to_pad_m=(0.0, 0.0, 0.0))
    node = EyesNode(system(), KEYS)
    if fits:
        node.receive_pad(pad)
        return
    with pytest.raises(UserError, match=r"the board is 1\.5 x 1\.5 m and the vehicle's pad 1\.5 x 1\.2 m"):
        node.receive_pad(pad)


@given(payload=st.binary(max_size=300))
def test_random_bytes_for_the_drones_state_are_counted(payload: bytes) -> None:
    node = EyesNode(system(), KEYS)
    node.receive_own(payload)
    assert node.counts.bad_payloads == 1


def test_attitudes_are_those_between_the_two_that_are_told() -> None:
    turning = tuple(
        Attitude(t_ns=step * 40_000_000, orientation_wxyz=quaternion_from_yaw(0.1 * step)) for step in (0, 1)
    )
    between = attitude_at(turning, 10_000_000)
    assert between is not None
    assert yaw_of(between) == pytest.approx(0.025, abs=1e-5)
    after = attitude_at(turning, 40_000_000 + GAP_MAX_NS)
    assert after == turning[1].orientation_wxyz
    assert attitude_at(turning, 40_000_001 + GAP_MAX_NS) is None
    assert attitude_at((), 0) is None


@pytest.mark.slow
def test_a_drone_that_turns_over_the_pad_tells_that_its_camera_is_mounted_otherwise() -> None:
    told = replace(MOUNTING, R_BC=matrix_of(np.array([0.09, 0.0, 0.0])) @ MOUNTING.R_BC)
    node, right = EyesNode(replace(system(), mounting=told), KEYS), EyesNode(system(), KEYS)
    for index in range(8):
        one = case(1.2, board=BOARD, roll_pitch_yaw_rad=(0.02, -0.01, 0.4 * index), t_ns=10**9 * (index + 1))
        for each in (node, right):
            each.receive_own(own(one))
            each.look(captured(one), shows=False)
    (told_once,) = [line for line in node.take_news() if "turned" in line]
    degrees = re.search(r"turned by ([0-9.]+) degrees", told_once)
    assert degrees is not None
    assert float(degrees[1]) == pytest.approx(math.degrees(0.09), abs=1.0)
    assert not [line for line in right.take_news() if "turned" in line]


@pytest.mark.slow
@pytest.mark.parametrize("off_rad", [(-0.3, 0.5), (0.0, -0.9)])
def test_camera_that_is_turned_so_far_that_no_sighting_is_believed_is_told_once(off_rad: tuple[float, float]) -> None:
    R_off = matrix_of(np.array([*off_rad, 0.0]))
    node = EyesNode(replace(system(), mounting=replace(MOUNTING, R_BC=R_off.T @ MOUNTING.R_BC)), KEYS)
    one = case(FAR_M, board=BOARD)
    for index in range(34):
        t_ns = 10**9 + index * 33_000_000
        node.receive_own(own(replace(one, frame=replace(one.frame, t_ns=t_ns))))
        assert node.look(replace(captured(one), t_ns=t_ns), shows=False) == []
    (told,) = node.take_news()
    degrees = re.search(r"lean by ([0-9]+) degrees", told)
    assert degrees is not None
    assert float(degrees[1]) == pytest.approx(math.degrees(math.hypot(*off_rad)), abs=1.0)
    found = [float(number) for number in re.findall(r"_rad = (-?[0-9.]+)", told)]
    assert found == pytest.approx(angles_of(MOUNTING.R_BC), abs=0.1)


@pytest.mark.slow
def test_board_that_leans_for_a_moment_is_not_told() -> None:
    node = EyesNode(system(), KEYS)
    level, leaning = case(FAR_M, board=BOARD), case(FAR_M, board=BOARD, roll_pitch_yaw_rad=(0.5, 0.0, 0.7))
    said = replace(leaning, frame=replace(leaning.frame, orientation_wxyz=level.frame.orientation_wxyz))
    for index in range(40):
        one = level if index % 20 == 19 else said
        t_ns = 10**9 + index * 33_000_000
        node.receive_own(own(replace(one, frame=replace(one.frame, t_ns=t_ns))))
        node.look(replace(captured(one), t_ns=t_ns), shows=False)
    assert set(node.take_news()) == {"pad seen", "pad lost"}
