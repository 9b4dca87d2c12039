"""Texts to pilots: whole, and few."""

from companion.component.component import Texts
from companion.situation.phases import Phase
from link.mavlink.dialect import mavlink
from link.messages import LandingStatus
from link.records import replace

S = 1_000_000_000
STATUS = LandingStatus(
    stamp_ns=0,
    phase="descend",
    reason="aligned",
    reason_code="ALIGNED",
    relative_position_enu_m=None,
    relative_velocity_enu_m_s=None,
    height_above_pad_m=None,
    time_to_contact_s=None,
    armed=True,
    fix_age_s=0.1,
)


def test_long_text_comes_whole_in_pieces_of_one_id() -> None:
    texts = Texts()
    for size in (39, 40, 89, 200):
        pieces = texts.pieces("x" * size, mavlink.MAV_SEVERITY_INFO)
        told = [piece.text for piece in pieces]
        assert "".join(told) == "Decklander " + "x" * size
        assert [piece.chunk_seq for piece in pieces] == list(range(len(pieces)))
        assert len({piece.id for piece in pieces}) == 1
        assert (pieces[0].id > 0) is (len(pieces) > 1)
        assert len(pieces) == 1 or len(told[-1]) < 50


def test_break_off_is_a_warning() -> None:
    (piece,) = Texts().news("abort: outside", Phase.ABORT, STATUS, 0)
    assert piece.severity == mavlink.MAV_SEVERITY_WARNING


def test_reasons_that_change_all_the_time_are_told_every_five_seconds_at_most() -> None:
    texts = Texts()
    texts.news("descend: aligned", Phase.DESCEND, STATUS, 0)
    waits = [replace(STATUS, reason_code=code) for code in ("MOMENT_RISKY", "NOT_OVER_PAD")]
    told = sum(bool(texts.progress(waits[tick // 75 % 2], tick * S // 50)) for tick in range(50 * 60))
    assert 8 <= told <= 12
    flicker = sum(bool(texts.progress(waits[tick % 2], (3000 + tick) * S // 50)) for tick in range(50 * 60))
    assert flicker == 0
