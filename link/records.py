"""Changed copies of the frozen records that the steps hand on, in half the time that `dataclasses.replace` takes.

`dataclasses.replace` asks every field whether it may be given and runs the constructor, which sets all of them by
keyword; with it a step of the companion takes a tenth longer. Here the fields are copied slot by slot. A type checker
sees `dataclasses.replace` itself, so names and types stay checked.
"""

from functools import cache
from typing import TYPE_CHECKING

__all__ = ["replace"]

if TYPE_CHECKING:
    from dataclasses import replace
else:
    from dataclasses import fields

    _set = object.__setattr__  # past the lock of a frozen record, as its own constructor does

    def replace(record, /, **changes):
        """Return a copy of `record`, a dataclass, with `changes` in their fields.

        Raises:
            TypeError: it has no such field, or is of a kind that derives something when it is made.
        """
        copy = object.__new__(type(record))
        for name in _names(type(record)):
            _set(copy, name, getattr(record, name))
        for name, value in changes.items():
            try:
                _set(copy, name, value)
            except AttributeError:
                raise TypeError(f"{type(record).__name__} has no field {name!r}") from None
        return copy

    @cache
    def _names(kind):
        """Return the names of a kind's fields."""
        if hasattr(kind, "__post_init__"):
            raise TypeError(f"{kind.__name__} derives something when it is made: use dataclasses.replace")
        return tuple(field.name for field in fields(kind))
