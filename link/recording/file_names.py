"""How the files of recordings are called: each start of a program makes a recording of its own in its folder.

The first one's are `companion_000.mcap`, `companion_001.mcap` and so on, the second one's `companion_2_000.mcap`.
"""

import re
from pathlib import Path
from typing import NamedTuple


class RecordingFile(NamedTuple):
    """A file, in the order in which they were written.

    Attributes:
        start: of the program in this folder, from 1.
        number: of the file since then, from 0.
    """

    start: int
    number: int
    path: Path


EYES_STEM = "eyes"
"""Of the recordings of what a detector saw, beside those of a companion."""


def recording_path(folder: Path, stem: str, start: int, number: int) -> Path:
    """Return where a file belongs."""
    return folder / (f"{stem}_{number:03d}.mcap" if start == 1 else f"{stem}_{start}_{number:03d}.mcap")


def present_files(folder: Path, stem: str) -> list[RecordingFile]:
    """Return the files of all recordings of one name in a folder, oldest first."""
    name = re.compile(rf"{re.escape(stem)}_(?:(?P<start>[0-9]+)_)?(?P<number>[0-9]{{3,}})\.mcap")
    return sorted(
        RecordingFile(int(match["start"] or 1), int(match["number"]), path)
        for path in folder.glob(f"{stem}_*.mcap")
        if (match := name.fullmatch(path.name)) is not None
    )


def free_path(path: Path) -> Path:
    """Return `path`, or where that exists the next of `<stem>_2`, `<stem>_3` that does not."""
    number, free = 1, path
    while free.exists():
        number += 1
        free = path.with_stem(f"{path.stem}_{number}")
    return free
