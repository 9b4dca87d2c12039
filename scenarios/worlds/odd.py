"""The operational design domain: every quantity that a landing depends on, with its distribution.

`odd.toml` holds it, each number with its source or its reason beside it. A quantity's name is its table and its key,
`driver.speed_m_s`; where it depends on a choice, such as the class of the road, it has one distribution for each case.
A slice is the same domain with other distributions for some quantities.
"""

import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Annotated, Self

from pydantic import Discriminator, Field, Tag, model_validator

from link.errors import UserError
from link.program.toml_config import StrictModel, validate
from scenarios.worlds.distributions import Choice, Graded, Plain

FILE = "scenarios/worlds/odd.toml"


class Cases(StrictModel):
    """A quantity whose distribution depends on the value of another one, `by`, which is a choice."""

    by: str
    cases: Annotated[dict[str, Plain], Field(min_length=1)]


def _tag(value: object) -> str:
    is_cases = "by" in value if isinstance(value, Mapping) else isinstance(value, Cases)
    return "cases" if is_cases else "plain"


Quantity = Annotated[Annotated[Plain, Tag("plain")] | Annotated[Cases, Tag("cases")], Discriminator(_tag)]
Tables = dict[str, dict[str, Quantity]]


class Domain(StrictModel):
    """The whole domain: what is drawn by table and key, and how each slice differs."""

    version: Annotated[int, Field(ge=1)]
    quantities: Tables
    slices: dict[str, Tables]

    @model_validator(mode="after")
    def _names_are_known(self) -> Self:
        names = _by_name(self.quantities)
        for slice_name, tables in self.slices.items():
            unknown = sorted(set(_by_name(tables)) - set(names))
            if unknown:
                raise ValueError(f"slice '{slice_name}' changes '{unknown[0]}', which is no quantity")
        for name, quantity in names.items():
            _check(name, quantity, names)
        return self


def _check(name: str, quantity: Cases | Plain, names: Mapping[str, Cases | Plain]) -> None:
    """Raise where `quantity` depends on what is not there, or has not one case for each value of a choice."""
    if isinstance(quantity, Cases):
        chosen = names.get(quantity.by)
        if chosen is None:
            raise ValueError(f"'{name}' goes by '{quantity.by}', which is no quantity")
        values = _values(chosen)
        if values != set(quantity.cases):
            raise ValueError(f"'{name}' needs one case for each of {', '.join(sorted(values))}")
        for one in quantity.cases.values():
            _check(name, one, names)
    elif isinstance(quantity, Graded) and quantity.quality not in names:
        raise ValueError(f"'{name}' goes by '{quantity.quality}', which is no quantity")


def _values(quantity: Cases | Plain) -> set[str]:
    cases = quantity.cases.values() if isinstance(quantity, Cases) else [quantity]
    return {str(value) for one in cases if isinstance(one, Choice) for value in one.values}


def _by_name(tables: Tables) -> dict[str, Cases | Plain]:
    return {f"{table}.{key}": quantity for table, keys in tables.items() for key, quantity in keys.items()}


@cache
def domain() -> Domain:
    """Return the domain as `odd.toml` has it."""
    text = (resources.files("scenarios") / "worlds" / "odd.toml").read_text(encoding="utf-8")
    return validate(Domain, tomllib.loads(text), source=FILE)


@cache
def quantities_of(slice_name: str) -> Mapping[str, Cases | Plain]:
    """Return the quantities of a slice by name; `world` is the whole domain, `world:NAME` one of its slices.

    Raises:
        UserError: there is no such slice.
    """
    whole = domain()
    head, _, part = slice_name.partition(":")
    if head != "world" or (part not in whole.slices if ":" in slice_name else False):
        raise UserError(f"no slice is called '{slice_name}'; there are {', '.join(slices())}")
    return _by_name(whole.quantities) | _by_name(whole.slices.get(part, {}))


def slices() -> tuple[str, ...]:
    """Return the names of all slices, the whole domain first."""
    return ("world", *(f"world:{name}" for name in domain().slices))
