"""What each setting means: the comment beside it, else what `meanings.toml` says of it."""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.resources import files

from scenarios.manual.field_comments import comments_of

_FILE = "meanings.toml"


def meaning_of(owner: type, key: str) -> str:
    """Return what a key of a table means, empty if nobody says so.

    Args:
        owner: the model of the table.
        key: in it.
    """
    comment = comments_of(owner).get(key, "")
    if comment:
        return comment
    told = _meanings()
    classes = [told[one.__name__] for one in owner.__mro__ if one.__name__ in told]
    return next((table[key] for table in (*classes, told["any"]) if key in table), "")


@cache
def _meanings() -> Mapping[str, Mapping[str, str]]:
    return tomllib.loads(files(__package__).joinpath(_FILE).read_text(encoding="utf-8"))
