"""The rule of the seeds, as a campaign keeps it: held-back worlds are flown on purpose, by a known commit, and once."""

from link.errors import UserError
from scenarios.campaigns.plan import Plan
from scenarios.recordings.versions import CHANGED
from scenarios.worlds.seeds import FlownRange, add_flown, check_not_flown, check_seeds, read_flown, release


def check_worlds(plan: Plan, *, held_back: bool) -> None:
    """Check that a campaign may fly its seeds; without worlds it may fly any.

    Args:
        plan: of the campaign.
        held_back: whether held-back worlds are meant.

    Raises:
        UserError: the seeds mix both kinds, are held back and not meant to be or flown already, are none of a world, or
            are held back and no commit could be named that flew them.
    """
    if not plan.populations:
        if held_back:
            raise UserError("--held-back is about the seeds of worlds: leave it out, or fly world or a slice of it")
        return
    check_seeds(plan.seed_range, held_back=held_back)
    if held_back:
        _commit_of(plan)
        check_not_flown(_slices(plan), plan.seed_range, read_flown())


def write_down_held_back(plan: Plan) -> None:
    """Write down that a campaign flies its worlds, which are held back; before it does, since then they are seen.

    Raises:
        UserError: the file cannot be written.
    """
    add_flown(
        FlownRange(
            slice=slice_name, first_seed=plan.first_seed, seeds=plan.seeds, release=release(), commit=_commit_of(plan)
        )
        for slice_name in _slices(plan)
    )


def _slices(plan: Plan) -> list[str]:
    """Return the slices of a campaign, each once."""
    return list(dict.fromkeys(one.slice for one in plan.populations.values()))


def _commit_of(plan: Plan) -> str:
    if plan.commit is None:
        raise UserError("--held-back needs a git repository: which commit flew these seeds is kept")
    if plan.commit.endswith(CHANGED):
        raise UserError("--held-back needs a clean working tree: commit first, so that what flew these seeds is known")
    return plan.commit
