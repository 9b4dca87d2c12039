import numpy as np
import pytest

from companion.eyes.board import Board, BoardConfig, TagConfig, load_board, nested_board
from companion.eyes.picture import Gray, WholePicture
from companion.eyes.sight import Frame, Sight, SightMemory, sight_step
from link.frames.rotations import matrix_from_quaternion
from link.records import replace
from scenarios.camera.lens import CAMERA
from scenarios.camera.lighting import Light
from tests.companion.eyes.frames import DAY, MOUNTING, Case, case, system

BOARD = load_board(None).config
DUSK = Light(daylight_lx=40.0)
EMPTY = SightMemory()


def look(one: Case, memory: SightMemory = EMPTY) -> Sight:
    return sight_step(memory, one.frame, system())[1]


def shades_of(one: Case) -> Gray:
    assert isinstance(one.frame.picture, WholePicture)
    return one.frame.picture.shades


def error_m(sight: Sight, one: Case) -> float:
    assert sight.sighting is not None
    return float(np.linalg.norm(np.array(sight.sighting.position_flu_m) - one.away_flu_m))


@pytest.mark.parametrize("range_m", [0.12, 0.31, 0.9, 2.2, 6.5, 13.0, 20.0])
@pytest.mark.parametrize("light", [DAY, DUSK], ids=["day", "dusk"])
def test_the_pad_is_seen_within_a_centimetre_and_a_percent_of_the_range(range_m: float, light: Light) -> None:
    one = case(range_m, board=BOARD, aside_m=(0.05, -0.03), light=light)
    assert error_m(look(one), one) < 0.01 + 0.01 * range_m


def test_a_pad_whose_middle_is_behind_the_camera_is_seen() -> None:
    one = case(0.3, board=BOARD, roll_pitch_yaw_rad=(0.9, 0.1, 0.4), aside_m=(0.1, 0.5))
    sight = look(one)
    assert sight.pose is not None
    assert sight.pose[1][2] < 0.0
    assert error_m(sight, one) < 0.005


def test_a_sighting_has_the_time_at_which_its_rows_were_read() -> None:
    one = case(6.0, board=BOARD, roll_pitch_yaw_rad=(0.0, 0.0, 0.0), aside_m=(0.0, 2.0))
    rolling = replace(system(), mounting=replace(MOUNTING, readout_s=0.02))
    sighting = sight_step(EMPTY, one.frame, rolling)[1].sighting
    assert sighting is not None
    right_px = 2.0 / 6.0 * CAMERA.focal_px  # of the middle: the long side of the picture is along the drone
    rows = CAMERA.size_px[1]
    assert (sighting.t_ns - one.frame.t_ns) * 1e-9 == pytest.approx(right_px / rows * 0.02, abs=0.0015)


@pytest.mark.parametrize("tilt_rad", [0.35, 0.7, 1.0])
def test_a_pad_seen_from_the_side_is_told_from_its_mirrored_pose(tilt_rad: float) -> None:
    one = case(9.0, board=BOARD, roll_pitch_yaw_rad=(tilt_rad, 0.1, -2.0))
    sight = look(one)
    assert sight.sighting is not None
    R_BP = matrix_from_quaternion(sight.sighting.orientation_wxyz)
    assert float((R_BP.T @ one.R_BP)[2, 2]) > np.cos(0.1)


def test_tracking_gives_what_a_search_gives() -> None:
    one = case(3.3, board=BOARD)
    memory, searched = sight_step(EMPTY, one.frame, system())
    _, tracked = sight_step(memory, replace(one.frame, t_ns=one.frame.t_ns + 33_000_000), system())
    assert (searched.tracked, tracked.tracked) == (False, True)
    assert searched.sighting is not None
    assert tracked.sighting is not None
    assert tracked.sighting.position_flu_m == pytest.approx(searched.sighting.position_flu_m, abs=0.002)


@pytest.mark.slow
def test_tracking_follows_a_pad_that_moves_as_before() -> None:
    # 0.1 m between frames is a third of the picture at this range: it is where it was going
    memory, sights = EMPTY, []
    for index in range(4):
        one = case(0.8, board=BOARD, aside_m=(0.1 * index - 0.2, 0.0), t_ns=10**9 + index * 100_000_000)
        memory, sight = sight_step(memory, one.frame, system())
        sights.append((sight, one))
    assert [sight.tracked for sight, _ in sights[2:]] == [True, True]
    assert max(error_m(*both) for both in sights) < 0.01


def test_a_pad_that_jumped_is_searched_for() -> None:
    memory, _ = sight_step(EMPTY, case(5.0, board=BOARD, aside_m=(2.0, 1.0)).frame, system())
    one = case(5.0, board=BOARD, aside_m=(-2.0, -1.0), t_ns=1_033_000_000)
    _, sight = sight_step(memory, one.frame, system())
    assert not sight.tracked
    assert error_m(sight, one) < 0.06


def test_another_board_is_no_pad_and_its_ids_are_told() -> None:
    other = nested_board(1.5, 63)
    sight = look(case(4.0, board=other))
    assert sight.sighting is None
    assert sight.foreign_ids
    assert sight.foreign_ids <= {tag.id for tag in other.tags}


def test_a_bare_roof_and_noise_are_no_pad() -> None:
    assert look(case(4.0, board=None)).sighting is None
    shades = np.random.default_rng(8).integers(0, 256, (720, 1280)).astype(np.uint8)
    noise = Frame(t_ns=0, picture=WholePicture(shades))
    assert sight_step(EMPTY, noise, system())[1].sighting is None


def test_a_track_is_given_up_when_the_pad_is_gone() -> None:
    memory, _ = sight_step(EMPTY, case(4.0, board=BOARD).frame, system())
    bare = case(4.0, board=None, t_ns=1_033_000_000)
    assert sight_step(memory, bare.frame, system())[1].sighting is None


def test_without_the_drones_attitude_the_pad_is_seen_and_no_better_than_with_it() -> None:
    one = case(9.0, board=BOARD)
    blind = sight_step(EMPTY, replace(one.frame, orientation_wxyz=None), system())[1]
    assert error_m(blind, one) < 0.1
    told = look(one)
    assert told.sighting is not None
    assert blind.sighting is not None
    assert sum(blind.sighting.position_covariance_m2) >= sum(told.sighting.position_covariance_m2) - 1e-9


def test_a_tag_that_is_at_the_wrong_place_does_not_move_the_pad() -> None:
    # the detector's board has one tag where the print has none
    tags = tuple(
        tag.model_copy(update={"center_m": (0.4, 0.4)}) if tag.id == BOARD.tags[7].id else tag for tag in BOARD.tags
    )
    wrong = Board(BOARD.model_copy(update={"tags": tags}))
    one = case(1.4, board=BOARD)
    sight = sight_step(EMPTY, one.frame, system(wrong))[1]
    assert BOARD.tags[7].id not in sight.tags
    assert error_m(sight, one) < 0.01


def grid(*, side_m: float = 0.3, left: float = 1.0) -> BoardConfig:
    """A board of four tags; with `left` -1 as somebody has it who counts to the right."""
    places = [(0.25, 0.25), (0.25, -0.25), (-0.25, 0.25), (-0.25, -0.25)]
    tags = (
        TagConfig(id=100 + number, center_m=(x_m, left * y_m), side_m=side_m)
        for number, (x_m, y_m) in enumerate(places)
    )
    return BoardConfig(size_m=(1.2, 1.2), tags=tuple(tags))


GRID = grid()


@pytest.mark.parametrize("told", [grid(side_m=0.24), grid(left=-1.0)], ids=["sides", "left and right"])
def test_board_whose_file_does_not_fit_the_print_is_not_seen_beside_its_place(told: BoardConfig) -> None:
    frame = case(6.0, board=GRID).frame
    assert len(sight_step(EMPTY, frame, system(Board(GRID)))[1].tags) == len(GRID.tags)
    sight = sight_step(EMPTY, frame, system(Board(told)))[1]
    assert sight.sighting is None
    assert sight.odd_ids


def test_track_that_began_with_one_tag_of_a_wrong_board_ends_once_the_others_are_seen() -> None:
    wrong = system(Board(grid(side_m=0.24)))
    one = case(6.0, board=GRID)
    pose = sight_step(EMPTY, one.frame, system(Board(GRID)))[1].pose
    assert pose is not None
    hidden = shades_of(one).copy()
    for tag in GRID.tags[1:]:
        column, row = CAMERA.pixels(Board(GRID).corners_m[tag.id].mean(axis=0)[None], *pose)[0][0].round().astype(int)
        hidden[row - 16 : row + 16, column - 16 : column + 16] = 200
    memory, sight = sight_step(EMPTY, replace(one.frame, picture=WholePicture(hidden)), wrong)
    assert sight.tags == (GRID.tags[0].id,)
    seen = []
    for step in range(1, 7):
        memory, sight = sight_step(memory, replace(one.frame, t_ns=one.frame.t_ns + step * 200_000_000), wrong)
        seen.append(sight.sighting is not None)
    assert not seen[-1]
    assert memory.track is None


@pytest.mark.parametrize("range_m", [4.0, 8.0])
def test_neither_of_two_boards_with_the_same_ids_is_the_pad(range_m: float) -> None:
    left, right = (
        case(range_m, board=BOARD, roll_pitch_yaw_rad=(0.0, 0.0, 0.0), aside_m=(aside_m, 0.1))
        for aside_m in (1.3, -1.3)
    )
    assert max(error_m(look(left), left), error_m(look(right), right)) < 0.01 + 0.01 * range_m
    middle = CAMERA.size_px[0] // 2
    both = np.hstack([shades_of(left)[:, :middle], shades_of(right)[:, middle:]])
    sight = look(replace(left, frame=replace(left.frame, picture=WholePicture(both))))
    assert sight.sighting is None
    assert 0 in sight.doubled_ids
