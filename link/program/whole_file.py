"""A file that is never without its content: it has the old one until the new one is on the disk."""

import os
from pathlib import Path


def replace_file(path: Path, data: bytes) -> None:
    """Write a file anew; who cannot, or is switched off meanwhile, leaves the old one.

    The new one is on the disk before it takes the other's name, or it could be empty after that.

    Raises:
        OSError: it cannot be written.
    """
    new = path.with_name(f"{path.name}.new")
    with new.open("wb") as file:
        try:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        except OSError:
            new.unlink()
            raise
    new.replace(path)
