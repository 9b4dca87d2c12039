"""What a program without I/O of its own wants put on Zenoh."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Publication:
    """A payload, the key it goes to and its encoding."""

    key: str
    payload: bytes
    encoding: str
