"""The pages of the manual that are made from the program, and the changes that are made to the written ones."""

import re
from collections.abc import Callable, Mapping
from functools import partial
from types import MappingProxyType

from companion.config.companion import CompanionConfig
from scenarios.config import Scenario
from scenarios.manual.commands import commands_page
from scenarios.manual.equations import equations_page
from scenarios.manual.folders import folders_page
from scenarios.manual.licences import licences_page
from scenarios.manual.parameters import parameters_page
from scenarios.manual.phase_chart import phase_chart, phases_page
from scenarios.manual.reasons import reasons_page
from scenarios.manual.settings import settings_page
from scenarios.manual.wire import wire_page
from sim_autopilot.runtime.config import SimAutopilotConfig

COMPANION = """The file is given as `companion --config FILE`; what it leaves out has its default, and an unknown
or unfit key is refused with its name. `companion --print-config` prints all of it, as a file to start from. A variable
`DECKLANDER_COMPANION__DESCENT__CONE__SLOPE=0.3` stands above the file, `--set descent.cone.slope=0.3` above both.
[Tuning](../tuning.md) says which keys are worth a change."""
SIM_AUTOPILOT = """The file is given as `sim-autopilot --config FILE`; what it leaves out has its default, and
`sim-autopilot --print-config` prints all of it. Variables such as `DECKLANDER_SIM_AUTOPILOT__WIND__MEAN_M_S=4` stand
above the file, options of the command line and `--set wind.mean_m_s=4` above both. Firmware
parameters go below `[parameters]`, by their own names."""
SCENARIO = """What a scenario's file may hold; [a scenario of your own](../own_scenario.md) shows how to write one.
`base` names a scenario to start from. `sensors`, `wind`, `link`, `vehicle` and `system` may be the name of a
preset instead of a table, or a table with `preset` as one of its keys. For `run`, `world`, `fly` and `ground-vehicle
--scenario`, variables such as `DECKLANDER_SCENARIO__TRACK__SPEED_M_S=6` stand above all that, `--set
system.companion.descent.cone.slope=0.3` above both."""

ELSEWHERE: Mapping[type, str] = MappingProxyType(
    {CompanionConfig: "All tables of the [companion's configuration](companion.md) may stand below this one."}
)

PAGES: Mapping[str, Callable[[], str]] = MappingProxyType(
    {
        "reference/commands.md": commands_page,
        "reference/companion.md": partial(
            settings_page, "Configuration of the companion", COMPANION, CompanionConfig, {}
        ),
        "reference/sim_autopilot.md": partial(
            settings_page, "Configuration of sim-autopilot", SIM_AUTOPILOT, SimAutopilotConfig, {}
        ),
        "reference/scenario.md": partial(settings_page, "Configuration of a scenario", SCENARIO, Scenario, ELSEWHERE),
        "reference/wire.md": wire_page,
        "reasons.md": reasons_page,
        "licences.md": licences_page,
        "reference/parameters.md": parameters_page,
        "reference/folders.md": folders_page,
        "equations.md": equations_page,
        "phases.md": partial(phases_page, "figures/phases.svg"),
        "figures/phases.svg": phase_chart,
    }
)
"""What makes each file, by its path in the manual."""

_MENTION = re.compile(r"(?<![\w/`(\[])docs/(\w+)\.md")
_FENCE = re.compile(r"(^```.*?^```$|`[^`\n]+`)", re.DOTALL | re.MULTILINE)
_CODE = re.compile(r"(?<!<pre>)<code>([^<]*)</code>")
_HYPHENED = re.compile(r"\S*-\S*")
_FETCHED = re.compile(
    r'<(?:script|img|iframe)[^>]+src="?(?:https?:)?//|<link[^>]+rel="?(?:stylesheet|preconnect)"?[^>]+https?://'
)


def fetched_from_elsewhere(html: str) -> str | None:
    """Return the first tag of a page by which a browser fetches what is not in the manual, None without one."""
    found = _FETCHED.search(html)
    return None if found is None else found[0]


def with_whole_options(html: str) -> str:
    """Return a page on which no line ends within an option such as `--speed-max`; blocks of code stay as they are."""
    return _CODE.sub(lambda found: f"<code>{_HYPHENED.sub(_whole, found[1])}</code>", html)


def _whole(word: re.Match[str]) -> str:
    return f'<span class="word">{word[0]}</span>'


def with_links(markdown: str, path: str) -> str:
    """Return a page on which each other page that it names, as `docs/safety.md`, is a link; code stays as it is.

    Args:
        markdown: of the page.
        path: of the page in the manual, such as `reference/wire.md`.
    """
    up = "../" * path.count("/")
    parts = _FENCE.split(markdown)
    return "".join(
        part if index % 2 else _MENTION.sub(lambda mention: _link(mention[1], up), part)
        for index, part in enumerate(parts)
    )


def _link(name: str, up: str) -> str:
    return f"[{name.replace('_', ' ')}]({up}{name}.md)"
