"""The files behind MAVLink FTP: what the server shows, which nobody can write, and what clients have put beside it.

Paths are plain names joined by slashes, without one at either end; the root is the empty path.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from errno import EACCES, EEXIST, EISDIR, ENOENT, ENOSPC, ENOTDIR, ENOTEMPTY
from types import MappingProxyType

from link.records import replace

Shown = Mapping[str, Callable[[], bytes]]
"""The server's own files by their paths, made when they are read."""

_WRITTEN_MAX = 4_000_000
"""Bytes that clients may leave, so that nobody fills the memory."""
_NAMES_MAX = 1000


@dataclass(frozen=True, slots=True, kw_only=True)
class Store:
    """What clients have written: files by their paths, and directories; the mapping is never written in place."""

    files: Mapping[str, bytes] = field(default_factory=lambda: MappingProxyType({}))
    directories: frozenset[str] = frozenset()


EMPTY_STORE = Store()


def plain_path(path: str) -> str:
    """Return a path as the store knows it; `..` leads nowhere above the root."""
    parts: list[str] = []
    for part in path.split("/"):
        if part == "..":
            parts = parts[:-1]
        elif part not in {"", "."}:
            parts.append(part)
    return "/".join(parts)


def is_directory(store: Store, shown: Shown, path: str) -> bool:
    """Return whether `path` is a directory: the root, one that was made, or one in which something is."""
    inside = f"{path}/"
    above = any(name.startswith(inside) for names in (shown, store.files, store.directories) for name in names)
    return path == "" or path in store.directories or above


def content(store: Store, shown: Shown, path: str) -> bytes:
    """Return a file's bytes.

    Raises:
        OSError: there is no such file.
    """
    if path in shown:
        return shown[path]()
    if path in store.files:
        return store.files[path]
    raise OSError(EISDIR if is_directory(store, shown, path) else ENOENT, path)


def entries(store: Store, shown: Shown, path: str) -> list[tuple[str, int | None]]:
    """Return names and sizes in a directory, in order; the size of a directory is None.

    Raises:
        OSError: there is no such directory.
    """
    if not is_directory(store, shown, path):
        raise OSError(ENOENT, path)
    inside = f"{path}/" if path else ""
    found: dict[str, int | None] = {}
    for name in sorted({*(one for one in shown if "?" not in one), *store.files, *store.directories}):
        first, slash, _ = name.removeprefix(inside).partition("/")
        if name.startswith(inside) and first:
            is_file = not slash and name not in store.directories
            found[first] = len(content(store, shown, name)) if is_file else None
    return sorted(found.items())


def write(store: Store, shown: Shown, path: str, offset: int, data: bytes, *, emptied: bool = False) -> Store:
    """Return the store with `data` at `offset` of the file `path`, which is made where it is not there.

    Raises:
        OSError: it cannot be written.
    """
    if path in shown:
        raise OSError(EACCES, path)
    if is_directory(store, shown, path):
        raise OSError(EISDIR, path)
    if not is_directory(store, shown, path.rpartition("/")[0]):
        raise OSError(ENOENT, path)
    before = b"" if emptied else store.files.get(path, b"")
    others = sum(len(one) for name, one in store.files.items() if name != path)
    if others + max(offset + len(data), len(before)) > _WRITTEN_MAX or len(store.files) >= _NAMES_MAX:
        raise OSError(ENOSPC, path)
    after = before[:offset].ljust(offset, b"\0") + data + before[offset + len(data) :]
    return replace(store, files={**store.files, path: after})


def cut(store: Store, shown: Shown, path: str, length: int) -> Store:
    """Return the store with a file cut, or filled with zeros, to `length`.

    Raises:
        OSError: there is no such file, or it cannot be written.
    """
    before = content(store, shown, path)
    return write(store, shown, path, 0, before[:length].ljust(min(length, _WRITTEN_MAX + 1), b"\0"), emptied=True)


def remove(store: Store, shown: Shown, path: str) -> Store:
    """Return the store without the file `path`.

    Raises:
        OSError: there is no such file, or it cannot be removed.
    """
    content(store, shown, path)
    if path in shown:
        raise OSError(EACCES, path)
    return replace(store, files={name: one for name, one in store.files.items() if name != path})


def rename(store: Store, shown: Shown, path: str, new: str) -> Store:
    """Return the store with the file `path` called `new`.

    Raises:
        OSError: there is no such file, or no place of that name.
    """
    data = content(store, shown, path)
    return write(remove(store, shown, path), shown, new, 0, data, emptied=True)


def with_directory(store: Store, shown: Shown, path: str) -> Store:
    """Return the store with one directory more.

    Raises:
        OSError: there is something of that name, or nothing above it.
    """
    if is_directory(store, shown, path) or path in shown or path in store.files:
        raise OSError(EEXIST, path)
    if not is_directory(store, shown, path.rpartition("/")[0]):
        raise OSError(ENOENT, path)
    if len(store.directories) >= _NAMES_MAX:
        raise OSError(ENOSPC, path)
    return replace(store, directories=store.directories | {path})


def without_directory(store: Store, shown: Shown, path: str) -> Store:
    """Return the store without an empty directory.

    Raises:
        OSError: there is no such directory, or something is in it, or it is the autopilot's own.
    """
    if not is_directory(store, shown, path):
        raise OSError(ENOTDIR if path in {*shown, *store.files} else ENOENT, path)
    if entries(store, shown, path) or path == "":
        raise OSError(ENOTEMPTY, path)
    return replace(store, directories=store.directories - {path})
