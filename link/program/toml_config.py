"""Configuration in TOML: read once, checked against a model, printed back; mistakes name the file and the key."""

import json
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from link.errors import UserError
from link.program.config_mistakes import Location, report
from link.program.text import read_text

POSITIVE_MIN = 1e-9
"""A nanometre or a nanosecond: nothing that is set is smaller, and what is divides to numbers that are none."""
Positive = Annotated[float, Field(ge=POSITIVE_MIN, le=1e4)]
NotNegative = Annotated[float, Field(ge=0.0, le=1e4)]
Coordinate = Annotated[float, Field(ge=-1e4, le=1e4)]
"""A length, time or speed beyond this was meant in another unit."""


def _ascending(bounds: tuple[float, float]) -> tuple[float, float]:
    if bounds[0] > bounds[1]:
        raise ValueError("the first number must not be more than the second")
    return bounds


Ascending = AfterValidator(_ascending)
Range = Annotated[tuple[NotNegative, NotNegative], Ascending]
"""The least and the most of something."""


class StrictModel(BaseModel):
    """A table of a configuration: no unknown keys, no infinite numbers, never changed after it was read.

    Nothing is converted: neither a text nor true is a number. A whole number is a number.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False, validate_default=True)


Model = TypeVar("Model", bound=StrictModel)

DEPTH_MAX = 20
"""How deep a configuration may be nested: none is half as deep, and what goes through one calls itself."""


def load_config(
    path: Path | None,
    model: type[Model],
    overrides: Mapping[str, Any] | None = None,
    environment: Mapping[str, Any] | None = None,
) -> Model:
    """Return the configuration in a file.

    Args:
        path: of the TOML file; None is an empty one.
        model: what it must fit.
        overrides: laid over all else, table by table; from the command line.
        environment: laid over the file's values; from variables.

    Raises:
        UserError: the file cannot be read, is no TOML, or a key or value does not fit.
    """
    table = {} if path is None else read_toml(path)
    source = "the defaults" if path is None else str(path)
    return validate(model, table, source=source, overrides=overrides, environment=environment)


def validate(
    model: type[Model],
    table: Mapping[str, Any],
    *,
    source: str,
    overrides: Mapping[str, Any] | None = None,
    environment: Mapping[str, Any] | None = None,
) -> Model:
    """Return `table` as a `model`, with what is laid over it as `load_config` says.

    Raises:
        UserError: with `source`, the first key that does not fit, its value and what would.
    """
    above, between = overrides or {}, environment or {}

    def source_of(location: Location) -> str:
        if not location:
            over = (("the environment", between), ("the command line", above))
            named = " and ".join(name for name, laid in over if _has_value(laid))
            return f"{source} with {named}" if named else source
        if _is_in(location, above):
            return "command line"
        return "environment" if _is_in(location, between) else source

    return _check(model, merge(merge(table, between), above) if between or above else table, source_of)


def _has_value(table: Mapping[str, Any]) -> bool:
    """Return whether anything is laid over by a table: None leaves what is below."""
    return any(_has_value(one) if isinstance(one, Mapping) else one is not None for one in table.values())


def merge(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Return `below` with the values of `above` laid over it, table by table; None leaves what is below."""
    both = dict(below)
    for key, value in above.items():
        if value is None:
            continue
        under = both.get(key)
        is_table = isinstance(value, Mapping)
        both[key] = merge(under if isinstance(under, Mapping) else {}, value) if is_table else value
    return both


def dump_toml(model: StrictModel) -> str:
    """Return the configuration as TOML that `load_config` reads back to the same; None values are left out."""
    import tomli_w  # noqa: PLC0415 (only where a configuration is printed)

    return tomli_w.dumps(model.model_dump(mode="json", exclude_none=True))


def read_toml(path: Path) -> dict[str, Any]:
    """Return the tables of a file.

    Raises:
        UserError: it cannot be read, or is no TOML.
    """
    return parse_toml(read_text(path), str(path))


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """Return the tables of a text, which `source` names.

    Raises:
        UserError: it is no TOML.
    """
    try:
        return tables_of(text)
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{source}: not valid TOML ({error})") from None
    except ValueError as error:  # what `_check_size` refuses
        raise UserError(f"{source}: not valid TOML ({str(error).partition(';')[0]})") from None
    except RecursionError:
        raise UserError(f"{source}: not valid TOML (nested too deep)") from None


def tables_of(text: str) -> dict[str, Any]:
    """Return the tables of TOML.

    Raises:
        ValueError: it is none, or has an integer of thousands of digits or a text with a NUL character.
        RecursionError: it is nested deeper than any configuration.
    """
    table = tomllib.loads(text)
    _check_size(table, DEPTH_MAX)
    return table


def _check_size(value: object, levels: int) -> None:
    """Find out whether `value` has at most so many levels, and nothing that no text or file's name can hold."""
    if levels < 0:
        raise RecursionError
    if isinstance(value, int):
        str(value)
    if isinstance(value, str) and "\0" in value:
        raise ValueError("a text has a NUL character")
    below = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    for one in below:
        _check_size(one, levels - 1)


def _check(model: type[Model], table: Mapping[str, Any], source_of: Callable[[Location], str]) -> Model:
    try:
        # as JSON, whose arrays and texts a strict model takes for tuples and enumerations
        return model.model_validate_json(json.dumps(table, default=str))
    except RecursionError:
        raise UserError(f"{source_of(())}: nested too deep") from None
    except ValidationError as error:
        # an unknown key goes first: misspelt, it is why another one is missing
        details = sorted(error.errors(include_url=False), key=lambda one: one["type"] != "extra_forbidden")
        raise UserError(report(details, model, source_of)) from None


def _is_in(location: Location, table: Mapping[str, Any]) -> bool:
    """Return whether the value at `location` comes from `table`."""
    node: Any = table
    for part in location:
        if not isinstance(node, Mapping):
            return True  # within a value that was given whole, such as a list
        if node.get(str(part)) is None:
            return False
        node = node[str(part)]
    return bool(location)  # what does not fit as a whole is the file's
