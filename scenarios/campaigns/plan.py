"""What a campaign flies: cells, seeds and versions, as `campaign.json` has them."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, model_validator

from companion.config.companion import CompanionConfig
from link.errors import UserError
from link.program.settings import COMPANION, load_settings, settings_of_environment, settings_of_options
from link.program.toml_config import StrictModel, merge, read_toml
from scenarios.campaigns.cells import Cell, Population, load_cell, with_companion
from scenarios.campaigns.landing_task import Task
from scenarios.catalogue.firmware_option import cells_with
from scenarios.config import Scenario
from scenarios.recordings.versions import commit, versions

_SEED_MAX = 2**63 - 1
"""Of 64 bits with a sign, as which the results keep it."""


class Plan(StrictModel):
    """What a campaign flies: each cell with the same seeds.

    Attributes:
        cells: their names.
        first_seed: the others follow.
        seeds: how many.
        versions: of what decides results.
        commit: of the sources, None where it is not known.
        scenarios: the cells that are one.
        populations: those that are a slice of the worlds, each seed one of its own.
    """

    cells: Annotated[list[str], Field(min_length=1)]
    first_seed: Annotated[int, Field(ge=0)]
    seeds: Annotated[int, Field(ge=1)]
    versions: dict[str, str]
    commit: str | None = None
    scenarios: dict[str, Scenario] = Field(default_factory=dict)
    populations: dict[str, Population] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _every_cell_is_something(self) -> Self:
        if sorted(self.cells) != sorted([*self.scenarios, *self.populations]):
            raise ValueError("each cell needs one scenario or population, and each of these one cell")
        return self

    @property
    def flown(self) -> Mapping[str, Cell]:
        """What each cell is, in their order."""
        known: dict[str, Cell] = {**self.scenarios, **self.populations}
        return {cell: known[cell] for cell in self.cells}

    @property
    def seed_range(self) -> range:
        """The seeds."""
        return range(self.first_seed, self.first_seed + self.seeds)

    def tasks(self) -> list[Task]:
        """Return all landings, the cells in turns: they advance together, and so the remaining time can be told."""
        return [Task(cell=cell, seed=seed) for seed in self.seed_range for cell in self.cells]


def make_plan(
    cells: Sequence[str],
    *,
    first_seed: int,
    seeds: int,
    config: Path | None,
    given: Sequence[str] | None = None,
    firmware: str | None = None,
) -> Plan:
    """Return what a campaign flies.

    Args:
        cells: names or files, as `load_scenario` takes them, or slices of the worlds.
        firmware: that each cell is flown with, `both` for each with both, None for the cell's own.
        first_seed: the others follow.
        seeds: how many.
        config: the companion's, laid over each scenario's own: only what it sets is changed.
        given: single settings of it, by `--set`.

    Raises:
        UserError: no such cell or firmware, two cells of one name, a seed that the results have no room for, or a
            configuration that does not fit.
    """
    if first_seed + seeds - 1 > _SEED_MAX:
        raise UserError(f"--first-seed {first_seed} and --seeds {seeds}: the last seed must be at most {_SEED_MAX}")
    loaded = [load_cell(cell) for cell in cells_with(cells, firmware)]
    names = [cell.name for cell in loaded]
    double = next((name for name in names if names.count(name) > 1), None)
    if double is not None:
        raise UserError(f"cell '{double}' is given twice")
    load_settings(config, CompanionConfig, COMPANION, given)  # by itself it has to fit as well
    changes = merge(settings_of_environment(COMPANION, CompanionConfig), settings_of_options(given))
    table = merge({} if config is None else read_toml(config), changes)
    if table:
        loaded = [with_companion(cell, table, "--set" if config is None else str(config)) for cell in loaded]
    return Plan(
        cells=names,
        first_seed=first_seed,
        seeds=seeds,
        versions=versions(),
        commit=commit(),
        scenarios={cell.name: cell for cell in loaded if isinstance(cell, Scenario)},
        populations={cell.name: cell for cell in loaded if isinstance(cell, Population)},
    )


def check_same_versions(plan: Plan) -> None:
    """Check that a campaign can be gone on with by these sources, since results of two would be mixed.

    Raises:
        UserError: something is not what it was.
    """
    now = versions()
    changed = [name for name in sorted({*now, *plan.versions}) if now.get(name) != plan.versions.get(name)]
    if changed:
        raise UserError(f"the campaign was begun with another version of {', '.join(changed)}: start a new one")
