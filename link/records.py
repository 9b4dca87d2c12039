"""Changed copies of records, which nobody writes in place.

What the steps make and hand on all the time are `msgspec.Struct`s: made in a tenth of the time that a frozen dataclass
takes, copied in a thirteenth. A type checker sees `dataclasses.replace`, so names and types stay checked.
"""

import dataclasses
from typing import TYPE_CHECKING

from msgspec import Struct, structs

__all__ = ["replace"]

if TYPE_CHECKING:
    from dataclasses import replace
else:

    def replace(record, /, **changes):
        """Return a copy of `record`, a struct or a dataclass, with `changes` in their fields.

        Raises:
            TypeError: it has no such field.
        """
        return (structs.replace if isinstance(record, Struct) else dataclasses.replace)(record, **changes)
