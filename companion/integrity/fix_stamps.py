"""How old the vehicle's newest fix was when it came: one from the future tells of a clock that is wrong; pure."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class FixStamps:
    """The newest accepted fix.

    Attributes:
        newest_ns: when it was taken, by its own stamp; None before the first.
        age_on_arrival_s: of it in the step that took it in, never negative where both clocks are right.
    """

    newest_ns: int | None = None
    age_on_arrival_s: float | None = None


def update_fix_stamps(stamps: FixStamps, newest_ns: int | None, t_ns: int) -> FixStamps:
    """Return the stamps with the newest fix as it is known at `t_ns`.

    Args:
        stamps: so far.
        newest_ns: stamp of the newest accepted fix.
        t_ns: now.
    """
    if newest_ns == stamps.newest_ns:
        return stamps
    return FixStamps(newest_ns=newest_ns, age_on_arrival_s=None if newest_ns is None else (t_ns - newest_ns) * 1e-9)
