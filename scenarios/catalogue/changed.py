"""A scenario with single settings changed, by the environment and the command line."""

from collections.abc import Sequence

from link.program.settings import SCENARIO, settings_of_environment, settings_of_options
from link.program.toml_config import validate
from scenarios.catalogue.catalogue import complete, load_scenario
from scenarios.config import Scenario


def load_changed_scenario(name_or_path: str, given: Sequence[str] | None) -> Scenario:
    """Return a scenario as `load_scenario` does, with what the environment and `--set` say laid over it.

    Args:
        name_or_path: of the scenario, a world's too.
        given: by `--set`; keys of the scenario, such as `system.companion.descent.cone.slope=0.3`.

    Raises:
        UserError: no such scenario, or a setting that does not fit.
    """
    scenario = load_scenario(name_or_path)
    environment, overrides = settings_of_environment(SCENARIO, Scenario), settings_of_options(given)
    if not environment and not overrides:
        return scenario
    table = scenario.model_dump(mode="json", exclude_none=True)
    changed = validate(Scenario, table, source=name_or_path, overrides=overrides, environment=environment)
    return complete(changed)
