"""One landing of a search as a task that any process can do."""

from dataclasses import dataclass

from scenarios.campaigns.landing_task import Task, error_line, fly
from scenarios.config import Scenario
from scenarios.lockstep.warm_up import warm_process
from scenarios.scoring.score import Tier


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """What is flown: a scenario as JSON, which is hashable and exact, with a seed.

    Attributes:
        index: in its batch.
        seed: of the run.
        scenario: as JSON.
    """

    index: int
    seed: int
    scenario: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Outcome:
    """What came of a trial; an error says why there is no margin.

    Attributes:
        margin: as `scenarios.scoring.margin` defines it, None without a result.
        tier: reached.
        reason: of the tier.
        time_to_contact_s: from the vehicle's passing the waiting point to the first contact, None without one.
        error: in one line.
    """

    margin: float | None
    tier: str | None
    reason: str | None
    time_to_contact_s: float | None = None
    error: str | None = None

    @property
    def is_unsafe(self) -> bool:
        """Whether it is what is searched for."""
        return self.tier == Tier.UNSAFE.value


def fly_trial(trial: Trial) -> Outcome:
    """Return what came of a trial; one that raises has its error as its outcome."""
    warm_process()
    scenario = Scenario.model_validate_json(trial.scenario)
    try:
        row = fly(Task(cell=scenario.name, seed=trial.seed), scenario)
    except Exception as error:  # noqa: BLE001 (one landing's fault must not end a search, and is reported)
        return lost(trial, error_line(error))
    return Outcome(
        margin=row["margin"], tier=row["tier"], reason=row["reason"], time_to_contact_s=row["time_to_contact_s"]
    )


def lost(_trial: Trial, why: str) -> Outcome:
    """Return the outcome of a trial that has no result."""
    return Outcome(margin=None, tier=None, reason=None, error=why)
