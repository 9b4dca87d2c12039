"""Texts of others: a file that a user names is read in bounded memory, and what a terminal would obey is not shown."""

from pathlib import Path

from link.errors import UserError


def printable(text: str) -> str:
    """Return `text` with the code in place of each character that is neither visible nor a space."""
    if text.isprintable():
        return text
    return "".join(one if one.isprintable() else ascii(one)[1:-1] for one in text)


_BYTES_MAX = 4 << 20
"""The longest of our own configurations has 20 kB; a device such as /dev/zero has no end."""


def read_bounded(path: Path, bytes_max: int = _BYTES_MAX) -> bytes:
    """Return a file's bytes.

    Raises:
        OSError: it cannot be read.
        ValueError: it is larger.
    """
    with path.open("rb") as file:
        data = file.read(bytes_max + 1)
    if len(data) > bytes_max:
        raise ValueError(f"it is larger than {bytes_max} bytes, which no such file is")
    return data


def read_text(path: Path) -> str:
    """Return a file's text; a byte order mark, as Windows' editors set one, is left out.

    Raises:
        UserError: it cannot be read, is too large or no UTF-8.
    """
    try:
        return read_bounded(path).decode("utf-8-sig")
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise UserError(f"{path}: not UTF-8 text") from None
    except ValueError:
        raise UserError(f"{path}: larger than {_BYTES_MAX >> 20} MB, which no such file is") from None
