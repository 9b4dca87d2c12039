"""The server by itself: whatever is asked, it answers once or bursts, and what is only shown stays as it is."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.ftp.server import answer, burst_on
from link.ftp.state import NO_FTP, Ftp, FtpRules
from link.ftp.wire import DATA_MAX, Opcode, Question

FILES = {"a/b.txt": b"some text", "long": bytes(1000)}
SHOWN = {name: (lambda data=data: data) for name, data in FILES.items()}
READ_ONLY = FtpRules(is_read_only=True, burst_a_step=1)
PATHS = st.sampled_from([b"a", b"a/b.txt", b"long", b"/", b"../long", b"a/b.txt\0c", b""])


def question(number: int, opcode: int, data: bytes, size: int, offset: int) -> Question:
    padded = data.ljust(DATA_MAX, b"\0")
    return Question(
        sequence=number, session=0, opcode=opcode, size=size, offset=offset, data=padded, system=255, component=190
    )


ASKED = st.tuples(
    st.integers(0, 255),
    st.one_of(PATHS, st.binary(max_size=DATA_MAX)),
    st.integers(0, 255),
    st.integers(0, 2**32 - 1),
)


@given(asked=st.lists(ASKED, max_size=20), rules=st.sampled_from([FtpRules(), READ_ONLY]))
def test_whatever_is_asked_is_answered_at_most_once(asked: list[tuple[int, bytes, int, int]], rules: FtpRules) -> None:
    ftp: Ftp = NO_FTP
    for number, (opcode, data, size, offset) in enumerate(asked):
        ftp, answers = answer(ftp, question(2 * number, opcode, data, size, offset), SHOWN, rules, number)
        assert len(answers) <= 1
        ftp, burst = burst_on(ftp, rules)
        assert len(burst) <= rules.burst_a_step
    if rules.is_read_only:
        assert ftp.store == NO_FTP.store


@pytest.mark.parametrize("steps", [1, 3])
def test_burst_goes_on_by_so_many_answers_a_step(steps: int) -> None:
    rules = FtpRules(burst_a_step=steps)
    ftp, _ = answer(NO_FTP, question(0, Opcode.OPEN_FILE_RO, b"long", 4, 0), SHOWN, rules, 0)
    ftp, answers = answer(ftp, question(2, Opcode.BURST_READ_FILE, b"", DATA_MAX, 0), SHOWN, rules, 0)
    assert answers == ()
    sent = []
    while ftp.burst is not None:
        ftp, burst = burst_on(ftp, rules)
        sent.append(len(burst))
    assert max(sent) == steps
    assert sum(sent) == -(-len(FILES["long"]) // DATA_MAX) + 1  # and its end
