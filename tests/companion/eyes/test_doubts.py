import numpy as np
import pytest

from companion.eyes.board import load_board
from companion.eyes.doubts import DoubtWatch, HintWatch, ids_text
from companion.eyes.picture import WholePicture
from companion.eyes.sight import Frame, Sight
from link.messages import PadSighting
from tests.companion.eyes.frames import MOUNTING, case

FRAME = Frame(t_ns=10**9, picture=WholePicture(np.zeros((2, 2), np.uint8)))
SEEN = Sight(
    sighting=PadSighting(
        t_ns=10**9,
        position_flu_m=(0.0, 0.0, -3.0),
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        position_covariance_m2=(1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 1e-4),
    )
)
DOUBTED = {
    "seen at two places": Sight(doubled_ids=frozenset({0, 3})),
    "not where the --board file has them": Sight(odd_ids=frozenset({101, 102, 103})),
    "which no deck does": Sight(leaning=(np.array([3.0, 0.4, 0.1]), np.array([0.3, -0.2, 4.0]))),
}


def told_of(watch: DoubtWatch, sights: list[Sight]) -> list[str]:
    return [line for sight in sights if (line := watch.update(FRAME, sight, MOUNTING)) is not None]


@pytest.mark.parametrize("why", DOUBTED)
def test_board_that_is_read_and_not_reported_for_a_second_is_told_once_with_its_cause(why: str) -> None:
    watch = DoubtWatch()
    assert told_of(watch, [DOUBTED[why]] * 29) == []
    (line,) = told_of(watch, [DOUBTED[why]] * 60)
    assert line.startswith("the board is read but not reported")
    assert why in line


def test_doubts_between_sightings_are_not_told() -> None:
    assert told_of(DoubtWatch(), [*[DOUBTED["seen at two places"]] * 20, SEEN] * 4) == []


def test_many_ids_are_told_by_the_first_of_them() -> None:
    assert ids_text(frozenset({7, 3})) == "3, 7"
    assert ids_text(frozenset(range(10, 17))) == "10, 11, 12, 13, 14 and 2 more"


@pytest.mark.parametrize(("before", "lines"), [(Sight(), 1), (Sight(foreign_ids=frozenset({80})), 0), (SEEN, 0)])
def test_mirrored_pictures_are_told_once_unless_a_tag_has_been_read_before(before: Sight, lines: int) -> None:
    board = load_board(None)
    shown = case(7.0, board=board.config).frame.picture
    assert isinstance(shown, WholePicture)
    mirrored = np.ascontiguousarray(shown.shades[:, ::-1])
    watch = HintWatch()
    watch.update(mirrored, before, board)
    told = [line for _ in range(150) if (line := watch.update(mirrored, Sight(), board)) is not None]
    assert len(told) == lines
    assert all("mirrored" in line for line in told)
