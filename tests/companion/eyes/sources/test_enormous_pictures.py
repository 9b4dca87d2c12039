"""A picture of some kilobytes that says to be enormous takes no memory of `pad-detector`."""

import subprocess
import sys

_PROGRAM = """
import struct, sys, zlib
from companion.eyes import __main__ as program
program.start = lambda *_: None
program.main()
from companion.eyes.sources.frames import gray_of_file
from link.messages import CompressedPicture
from link.payloads.checks import PayloadError

def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

def png(side_px: int) -> bytes:
    head = struct.pack(">IIBBBBB", side_px, side_px, 8, 0, 0, 0, 0)
    rows = zlib.compress(bytes(200_000))
    return b"\\x89PNG\\r\\n\\x1a\\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")

for side_px in (300, 30_000):
    try:
        told = str(gray_of_file(CompressedPicture(t_ns=1, format="png", data=png(side_px))).shape)
    except PayloadError as error:
        told = str(error)
    sys.stdout.write(told + "\\n")
"""


def test_file_that_claims_more_pixels_than_a_raw_picture_may_have_is_refused_before_room_is_made_for_it() -> None:
    ended = subprocess.run([sys.executable, "-c", _PROGRAM], check=True, capture_output=True, text=True)
    small, enormous = ended.stdout.splitlines()
    assert small == "(300, 300)"
    assert "CV_IO_MAX_IMAGE_PIXELS" in enormous
