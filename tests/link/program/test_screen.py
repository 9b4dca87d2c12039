"""What a status looks like to people: every row whatever is known, and the words as they are."""

import io

import pytest
from rich.console import Console

from link.messages import LandingStatus, LinkStatus
from link.program.screen import Screen
from link.program.status_rows import status_rows
from link.records import replace

STATUS = LandingStatus(
    stamp_ns=1,
    phase="descend",
    reason="aligned [within 0.2 m]",
    relative_position_enu_m=(0.3, -0.4, 1.234),
    relative_velocity_enu_m_s=(0.0, 0.1, -0.5),
    height_above_pad_m=1.234,
    time_to_contact_s=2.5,
    armed=True,
    fix_age_s=None,
)


def test_rows_state_each_value_with_its_unit_and_a_dash_for_the_unknown() -> None:
    rows = dict(status_rows(STATUS))
    assert rows["height above the pad"] == "1.23 m"
    assert rows["horizontal distance"] == "0.50 m"
    assert rows["relative velocity"] == "+0.00, +0.10, -0.50 m/s"
    assert rows["age of the last fix"] == "-"
    assert list(rows) == [name for name, _ in status_rows(None)]
    assert {value for _, value in status_rows(None)} == {"-"}


def test_panel_shows_phase_reason_and_further_rows_below_the_lines_that_stay() -> None:
    drawn = io.StringIO()
    screen = Screen("run [1]", Console(file=drawn, width=80))
    screen.start()
    screen.write_above("10.0 s [chase]")
    screen.show(STATUS, [("pace", "2.00x")])
    screen.stop()
    text = drawn.getvalue()
    for words in ("run [1]", "descend", "aligned [within 0.2 m]", "1.23 m", "2.00x"):
        assert words in text
    assert text.index("10.0 s [chase]") < text.index("run [1]")


@pytest.mark.parametrize("width", [60, 80, 200])
def test_panel_has_the_same_height_and_fits_whatever_it_has_to_say(width: int) -> None:
    heights = set()
    for reason in ("", "aligned", "the vehicle's road is said to be 30.0 m below the ground 12 m from it: " * 5):
        drawn = io.StringIO()
        screen = Screen("companion on " + "x" * 90, Console(file=drawn, width=width))
        screen.start()
        screen.show(replace(STATUS, reason=reason, links=LinkStatus(refused=reason)), [("pace", reason)])
        screen.stop()
        lines = [line for line in drawn.getvalue().splitlines() if line.strip()]
        assert max(map(len, lines)) <= min(width, 80)
        heights.add(len(lines))
    assert len(heights) == 1
