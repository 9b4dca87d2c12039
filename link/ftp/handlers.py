"""What each question of MAVLink FTP does: the server after it, and the data that answer it, None where a burst does."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from zlib import crc32

from link.ftp.state import Burst, Case, Ftp, Opened, RefusedError
from link.ftp.store import (
    content,
    cut,
    entries,
    plain_path,
    remove,
    rename,
    with_directory,
    without_directory,
    write,
)
from link.ftp.wire import DATA_MAX, Error, Opcode
from link.records import replace

_ALL_BITS = 0xFFFFFFFF

_Done = tuple[Ftp, bytes | None]


def _do_nothing(ftp: Ftp, _case: Case) -> _Done:
    return ftp, b""


def _close(ftp: Ftp, case: Case) -> _Done:
    another = ftp.opened is not None and case.question.session != ftp.opened.session
    if another and not case.rules.own_session:
        return ftp, b""  # which ArduPilot grants, and nothing happens
    if case.rules.own_session and case.question.opcode == Opcode.TERMINATE_SESSION and ftp.opened is None:
        raise RefusedError(Error.INVALID_SESSION)
    return replace(ftp, opened=None, burst=None), b""


def _list(ftp: Ftp, case: Case) -> _Done:
    found = entries(ftp.store, case.shown, case.path)
    names = ["S", "S"] if case.rules.names_itself else []
    names += [f"D{name}" if size is None else f"F{name}\t{size}" for name, size in found]
    lines = [name.encode() + case.rules.entry_end for name in names]
    data = b""
    for line in lines[case.question.offset :]:
        if len(data) + len(line) > DATA_MAX:
            break
        data += line
    if not data:
        raise RefusedError(Error.END_OF_FILE)
    return ftp, data


def _open(ftp: Ftp, case: Case) -> _Done:
    question, rules = case.question, case.rules
    if ftp.opened is not None:
        raise RefusedError(rules.busy)
    session = 0 if rules.own_session else question.session
    if question.opcode == Opcode.OPEN_FILE_RO:
        path = case.path if case.path in case.shown else case.path.partition("?")[0]
        data = content(ftp.store, case.shown, path)
        opened = Opened(path=case.path, data=data, session=session)
        return replace(ftp, opened=opened), len(data).to_bytes(4, "little")
    emptied = question.opcode == Opcode.CREATE_FILE
    store = write(ftp.store, case.shown, case.path, 0, b"", emptied=emptied)
    size = len(store.files[case.path]).to_bytes(4, "little") if rules.own_session else b""
    return replace(ftp, store=store, opened=Opened(path=case.path, data=None, session=session)), size


def _find_opened(ftp: Ftp, case: Case, *, reads: bool) -> Opened:
    opened, rules = ftp.opened, case.rules
    if opened is None:
        raise RefusedError(rules.not_open)
    if case.question.session != opened.session:
        raise RefusedError(Error.INVALID_SESSION)
    if (opened.data is not None) is not reads:
        raise RefusedError(Error.FAIL)
    return opened


def _read(ftp: Ftp, case: Case) -> _Done:
    data = _find_opened(ftp, case, reads=True).data or b""
    part = data[case.question.offset :][: case.question.size]
    if not part:
        raise RefusedError(Error.END_OF_FILE)
    return ftp, part


def _write(ftp: Ftp, case: Case) -> _Done:
    opened, question = _find_opened(ftp, case, reads=False), case.question
    data = question.data[: question.size]
    store = write(ftp.store, case.shown, opened.path, question.offset, data)
    size = len(data).to_bytes(4, "little") if case.rules.own_session else b""
    return replace(ftp, store=store), size


def _begin_burst(ftp: Ftp, case: Case) -> _Done:
    _find_opened(ftp, case, reads=True)
    question, rules = case.question, case.rules
    size = question.size if rules.burst_of_any_size and question.size else DATA_MAX
    burst = Burst(
        offset=question.offset,
        end=question.offset + rules.burst_bytes,
        size=size,
        sequence=question.sequence + 1,
        partner=(question.system, question.component),
    )
    return replace(ftp, burst=burst), None


def _remove(ftp: Ftp, case: Case) -> _Done:
    return replace(ftp, store=remove(ftp.store, case.shown, case.path)), b""


def _make_directory(ftp: Ftp, case: Case) -> _Done:
    return replace(ftp, store=with_directory(ftp.store, case.shown, case.path)), b""


def _remove_directory(ftp: Ftp, case: Case) -> _Done:
    return replace(ftp, store=without_directory(ftp.store, case.shown, case.path)), b""


def _truncate(ftp: Ftp, case: Case) -> _Done:
    return replace(ftp, store=cut(ftp.store, case.shown, case.path, case.question.offset)), b""


def _rename(ftp: Ftp, case: Case) -> _Done:
    old, _, new = case.question.text.partition("\0")
    new_path = plain_path(new.partition("\0")[0])
    return replace(ftp, store=rename(ftp.store, case.shown, plain_path(old), new_path)), b""


def _check(ftp: Ftp, case: Case) -> _Done:
    return ftp, checksum(content(ftp.store, case.shown, case.path)).to_bytes(4, "little")


def checksum(data: bytes) -> int:
    """Return the CRC-32 of a file as both servers reckon it: without the two inversions that are usual."""
    return crc32(data, _ALL_BITS) ^ _ALL_BITS


HANDLERS: Mapping[int, Callable[[Ftp, Case], _Done]] = MappingProxyType(
    {
        Opcode.NONE: _do_nothing,
        Opcode.TERMINATE_SESSION: _close,
        Opcode.RESET_SESSIONS: _close,
        Opcode.LIST_DIRECTORY: _list,
        Opcode.OPEN_FILE_RO: _open,
        Opcode.READ_FILE: _read,
        Opcode.CREATE_FILE: _open,
        Opcode.WRITE_FILE: _write,
        Opcode.REMOVE_FILE: _remove,
        Opcode.CREATE_DIRECTORY: _make_directory,
        Opcode.REMOVE_DIRECTORY: _remove_directory,
        Opcode.OPEN_FILE_WO: _open,
        Opcode.TRUNCATE_FILE: _truncate,
        Opcode.RENAME: _rename,
        Opcode.CALC_FILE_CRC32: _check,
        Opcode.BURST_READ_FILE: _begin_burst,
    }
)
WRITING = frozenset(
    {
        Opcode.CREATE_FILE,
        Opcode.WRITE_FILE,
        Opcode.REMOVE_FILE,
        Opcode.CREATE_DIRECTORY,
        Opcode.REMOVE_DIRECTORY,
        Opcode.OPEN_FILE_WO,
        Opcode.TRUNCATE_FILE,
        Opcode.RENAME,
    }
)
"""What changes files."""
