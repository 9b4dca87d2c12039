"""What a campaign flies as one cell: a scenario that every seed flies, or a slice of the worlds, one for each seed."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from pydantic import Field

from companion.config.companion import CompanionConfig
from link.program.toml_config import StrictModel, merge, validate
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.world_names import WorldName, names_worlds, parse_world_name
from scenarios.catalogue.worlds import drawn_world
from scenarios.config import FirmwareName, Scenario

Table = Mapping[str, Any]
WORLD_COLUMN = "world."
"""Before the name of what a world drew, as a column of its landing's row."""


class Population(StrictModel):
    """The worlds of a slice.

    Attributes:
        slice: that they are drawn of.
        firmware: that all are flown with, None for what each draws.
        companion: laid over the configuration of the companion in each.
    """

    slice: str
    firmware: FirmwareName | None = None
    companion: dict[str, Any] = Field(default_factory=dict)

    @property
    def name(self) -> str:
        """The name of its cell."""
        return self.world_name(None)

    def world_name(self, seed: int | None) -> str:
        """Return the name of one of its worlds."""
        return WorldName(slice=self.slice, seed=seed, firmware=self.firmware).text


Cell = Scenario | Population


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """What one seed of a cell flies, and what was drawn for it, by column."""

    scenario: Scenario
    columns: Table = field(default_factory=dict)


def load_cell(name: str) -> Cell:
    """Return the cell called `name`: a slice of the worlds, or anything that `load_scenario` takes.

    Raises:
        UserError: there is none.
    """
    if names_worlds(name):
        world = parse_world_name(name)
        if world.seed is None:
            return Population(slice=world.slice, firmware=world.firmware)
    return load_scenario(name)


def draw(cell: Cell, seed: int) -> Drawn:
    """Return what `seed` flies; only these two decide it, on any machine."""
    if isinstance(cell, Scenario):
        return Drawn(scenario=cell)
    world = drawn_world(WorldName(slice=cell.slice, firmware=cell.firmware), seed)
    return Drawn(
        scenario=_laid_over(world.scenario, cell.companion, "--config"),
        columns={f"{WORLD_COLUMN}{name}": value for name, value in world.drawn.items()},
    )


def with_companion(cell: Cell, table: Table, source: str) -> Cell:
    """Return `cell` with a table of the companion's configuration laid over its own, or that of each of its worlds.

    Raises:
        UserError: it does not fit over a scenario's own.
    """
    if isinstance(cell, Scenario):
        return _laid_over(cell, table, source)
    return cell.model_copy(update={"companion": dict(table)})


def _laid_over(scenario: Scenario, table: Table, source: str) -> Scenario:
    if not table:
        return scenario
    below = scenario.system.companion.model_dump(mode="json")
    companion = validate(CompanionConfig, merge(below, table), source=f"{source} over {scenario.name}")
    system = scenario.system.model_copy(update={"companion": companion})
    return scenario.model_copy(update={"system": system})
