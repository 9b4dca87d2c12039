"""Configuration in TOML: read once, checked against a model, printed back; mistakes name the file and the key."""

import difflib
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from link.errors import UserError


class StrictModel(BaseModel):
    """A table of a configuration: no unknown keys, no infinite numbers, never changed after it was read."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, validate_default=True)


Model = TypeVar("Model", bound=StrictModel)


def load_config(path: Path | None, model: type[Model], overrides: Mapping[str, Any] | None = None) -> Model:
    """Return the configuration in a file.

    Args:
        path: of the TOML file; None is an empty one.
        model: what it must fit.
        overrides: laid over the file's values, table by table.

    Raises:
        UserError: the file cannot be read, is no TOML, or a key or value does not fit.
    """
    table = {} if path is None else _read(path)
    return validated(model, merged(table, overrides or {}), source="the defaults" if path is None else str(path))


def validated(model: type[Model], table: Mapping[str, Any], *, source: str) -> Model:
    """Return `table` as a `model`.

    Raises:
        UserError: with `source`, the first key that does not fit, its value and what would.
    """
    try:
        return model.model_validate(dict(table))
    except ValidationError as error:
        details = error.errors(include_url=False)
        raise UserError(_sentence(details[0], model, source, len(details) - 1)) from None


def merged(below: Mapping[str, Any], above: Mapping[str, Any]) -> dict[str, Any]:
    """Return `below` with the values of `above` laid over it, table by table."""
    both = dict(below)
    for key, value in above.items():
        under = both.get(key)
        tables = isinstance(under, Mapping) and isinstance(value, Mapping)
        both[key] = merged(under, value) if tables else value  # type: ignore[arg-type]  # both are mappings here
    return both


def dump_toml(model: StrictModel) -> str:
    """Return the configuration as TOML that `load_config` reads back to the same; None values are left out."""
    import tomli_w  # noqa: PLC0415 (only where a configuration is printed)

    return tomli_w.dumps(model.model_dump(mode="json", exclude_none=True))


def _read(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise UserError(f"{path}: cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise UserError(f"{path}: not UTF-8 text") from None
    except tomllib.TOMLDecodeError as error:
        raise UserError(f"{path}: not valid TOML ({error})") from None


def _sentence(details: ErrorDetails, model: type[BaseModel], source: str, further: int) -> str:
    """Return one line that names the file, the key, the value and what would fit."""
    location = details["loc"]
    key = ".".join(str(part) for part in location)
    if details["type"] == "extra_forbidden":
        text = f"{source}: unknown key '{key}'{_nearest(location, model)}"
    elif details["type"] == "missing":
        text = f"{source}: key '{key}' is missing"
    else:
        text = f"{source}: {key} = {details['input']!r} does not fit: {_lowered(details['msg'])}"
    return f"{text} ({further} more like this)" if further else text


def _lowered(message: str) -> str:
    return message[:1].lower() + message[1:]


def _nearest(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    """Return a hint to the nearest valid key of the same table, or all of them when none is near."""
    table: Any = model
    for part in location[:-1]:
        field = getattr(table, "model_fields", {}).get(part)
        table = None if field is None else field.annotation
    names = list(getattr(table, "model_fields", {}))
    near = difflib.get_close_matches(str(location[-1]), names, n=1)
    if near:
        return f", did you mean '{near[0]}'?"
    return f"; valid are {', '.join(names)}" if names else ""
