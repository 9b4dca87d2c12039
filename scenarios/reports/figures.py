"""The figures of a run's or a campaign's folder, whichever it is."""

from pathlib import Path

from matplotlib.figure import Figure

from scenarios.campaigns.folder import read_landings, read_plan
from scenarios.reports.campaign_figures import campaign_figures
from scenarios.reports.figure_files import save_all
from scenarios.reports.run_data import read_run
from scenarios.reports.run_figures import run_figures


def is_campaign(folder: Path) -> bool:
    """Return whether the folder is a campaign's."""
    return folder.joinpath("campaign.json").exists()


def figures_of(folder: Path) -> dict[str, Figure]:
    """Return the figures by name.

    Raises:
        UserError: the folder holds neither a recorded run nor a campaign.
    """
    if is_campaign(folder):
        return campaign_figures(read_plan(folder), read_landings(folder))
    return run_figures(read_run(folder))


def draw_figures(folder: Path, out: Path | None) -> list[Path]:
    """Draw the figures into `out`, or `figures` in the folder, and return the files.

    Raises:
        UserError: nothing can be drawn, or written.
    """
    return save_all(figures_of(folder), out or folder / "figures")
