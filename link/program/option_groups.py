"""Options that several commands share, as dataclasses: a command takes a group as one argument.

typer knows single options only, so a group's fields become the command's own before typer sees it.
"""

import dataclasses
import inspect
from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any, get_type_hints


class OptionGroup:
    """The base of a frozen dataclass whose fields are options, `Annotated[type, typer.Option(...)]` with a default."""


def ungrouped(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a command whose options stand singly, which calls `function` with its groups."""
    hints = get_type_hints(function, include_extras=True)
    groups = {name: hint for name, hint in hints.items() if isinstance(hint, type) and issubclass(hint, OptionGroup)}
    if not groups:
        return function
    parameters: list[inspect.Parameter] = []
    for one in inspect.signature(function).parameters.values():
        single = one.replace(annotation=hints.get(one.name, one.annotation))
        parameters += _options_of(groups[one.name]).values() if one.name in groups else [single]

    @wraps(function)
    def command(**values: Any) -> Any:
        for name, group in groups.items():
            values[name] = group(**{option: values.pop(option) for option in _options_of(group)})
        return function(**values)

    keyword_only = [one.replace(kind=inspect.Parameter.KEYWORD_ONLY) for one in parameters]
    command.__signature__ = inspect.Signature(keyword_only)  # type: ignore[attr-defined]  # as inspect documents it
    command.__annotations__ = {one.name: one.annotation for one in parameters}
    return command


def _options_of(group: Any) -> Mapping[str, inspect.Parameter]:
    hints = get_type_hints(group, include_extras=True)
    return {
        one.name: inspect.Parameter(
            one.name, inspect.Parameter.KEYWORD_ONLY, default=one.default, annotation=hints[one.name]
        )
        for one in dataclasses.fields(group)
    }
