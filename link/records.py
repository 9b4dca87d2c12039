"""Changed copies of the frozen records that the steps hand on, in a sixth of the time that `dataclasses.replace` takes.

That one asks every field whether it may be given and then runs the constructor, which writes past the lock of a frozen
record field by field; for the steps' memories this amounts to a tenth of a whole step. Here the fields are written
plainly, to an open twin of the record with the same slots, which then becomes a record. A type checker sees
`dataclasses.replace`, so names and types stay checked.
"""

from functools import cache
from typing import TYPE_CHECKING

__all__ = ["replace"]

if TYPE_CHECKING:
    from dataclasses import replace
else:

    def replace(record, /, **changes):
        """Return a copy of `record`, a dataclass with slots, with `changes` in their fields.

        Raises:
            TypeError: it has no such field, or is of a kind that derives something when it is made.
        """
        kind = type(record)
        copy = _copier(kind)(record)
        for name, value in changes.items():
            try:
                setattr(copy, name, value)
            except AttributeError:
                raise TypeError(f"{kind.__name__} has no field {name!r}") from None
        copy.__class__ = kind
        return copy

    @cache
    def _copier(kind):
        """Return what copies all fields of a kind of record to its twin, written out: a loop takes twice as long."""
        if hasattr(kind, "__post_init__"):
            raise TypeError(f"{kind.__name__} derives something when it is made: use dataclasses.replace")
        twin = type(f"Open{kind.__name__}", (), {"__slots__": kind.__slots__})
        lines = ["def copied(record):", " copy = new(twin)"]
        lines += [f" copy.{name} = record.{name}" for name in kind.__slots__]
        names = {"new": object.__new__, "twin": twin}
        exec("\n".join([*lines, " return copy"]), names)  # noqa: S102 (as dataclasses writes its constructors)
        return names["copied"]
