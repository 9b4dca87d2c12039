"""MAVLink FTP as a machine without time or link of its own: one file open at a time, answers at once, bursts in parts.

Source: https://mavlink.io/en/services/ftp.html; sessions, errors and ends as each firmware's own server has them.
"""

from errno import EEXIST, ENOENT

from link.ftp.handlers import HANDLERS, WRITING
from link.ftp.state import Case, Ftp, FtpRules, RefusedError
from link.ftp.store import Shown
from link.ftp.wire import DATA_MAX, Error, Opcode, Question, Reply, reply_message
from link.mavlink.dialect import Message
from link.records import replace

_SEQUENCES = 1 << 16


def answer(
    ftp: Ftp, question: Question, shown: Shown, rules: FtpRules, boot_ns: int
) -> tuple[Ftp, tuple[Message, ...]]:
    """Return the server after a question at `boot_ns`, and its answer; a burst follows by `burst_on`."""
    partner = (question.system, question.component)
    if ftp.last is not None and ftp.last[:2] == ((question.sequence + 1) % _SEQUENCES, partner):
        return ftp, (ftp.last[2],)
    idle = (boot_ns - ftp.asked_ns) * 1e-9 > rules.idle_s
    if idle and ftp.opened is not None:
        ftp = replace(ftp, opened=None, burst=None)
    ftp = replace(ftp, asked_ns=boot_ns, last=None)
    try:
        ftp, reply = _handle(ftp, Case(question=question, shown=shown, rules=rules))
    except RefusedError as refused:
        reply = _refusal(question, bytes([refused.error]))
    except OSError as failed:
        reply = _refusal(question, _error_bytes(failed.errno or 0))
    if reply is None:
        return ftp, ()
    sequence = question.sequence + 1
    message = reply_message(reply, sequence, *partner)
    small = len(reply.data) <= 4
    return replace(ftp, last=(sequence % _SEQUENCES, partner, message) if small else None), (message,)


def burst_on(ftp: Ftp, rules: FtpRules) -> tuple[Ftp, tuple[Message, ...]]:
    """Return the server one step on, and the answers of a burst under way that go now."""
    messages: list[Message] = []
    while ftp.burst is not None and len(messages) < rules.burst_a_step:
        burst, opened = ftp.burst, ftp.opened
        data = b"" if opened is None or opened.data is None else opened.data
        part = data[burst.offset : burst.offset + burst.size]
        end = burst.offset + len(part)
        session = 0 if rules.own_session or opened is None else opened.session
        reply = Reply(
            session=session,
            asked=Opcode.BURST_READ_FILE,
            offset=burst.offset,
            data=part or bytes([Error.END_OF_FILE]),
            is_refusal=not part,
            is_last_of_burst=bool(part) and end >= burst.end,
        )
        messages.append(reply_message(reply, burst.sequence, *burst.partner))
        goes_on = bool(part) and end < burst.end
        ftp = replace(ftp, burst=replace(burst, offset=end, sequence=burst.sequence + 1) if goes_on else None)
    return ftp, tuple(messages)


def _refusal(question: Question, data: bytes) -> Reply:
    return Reply(session=question.session, asked=question.opcode, offset=question.offset, data=data, is_refusal=True)


def _error_bytes(number: int) -> bytes:
    known = {EEXIST: Error.FILE_EXISTS, ENOENT: Error.FILE_NOT_FOUND}.get(number)
    return bytes([Error.FAIL_ERRNO, number]) if known is None else bytes([known])


def _handle(ftp: Ftp, case: Case) -> tuple[Ftp, Reply | None]:
    question, rules = case.question, case.rules
    if question.opcode in {Opcode.ACK, Opcode.NAK}:
        return ftp, None
    if question.size > DATA_MAX:
        raise RefusedError(Error.INVALID_DATA_SIZE)
    handler = HANDLERS.get(question.opcode)
    if handler is None or (question.opcode == Opcode.TRUNCATE_FILE and not rules.truncates):
        raise RefusedError(rules.unknown)
    if rules.is_read_only and question.opcode in WRITING:
        raise RefusedError(Error.FILE_PROTECTED)
    ftp, data = handler(ftp, case)
    if data is None:
        return ftp, None
    opens = question.opcode in {Opcode.OPEN_FILE_RO, Opcode.OPEN_FILE_WO, Opcode.CREATE_FILE}
    session = 0 if rules.own_session and opens else question.session
    return ftp, Reply(session=session, asked=question.opcode, offset=question.offset, data=data)
