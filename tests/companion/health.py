"""What an estimator would say of its measurements."""

from collections.abc import Mapping
from typing import Any

from companion.core.data import Quantity
from companion.vehicle.estimator import BufferHealth
from companion.vehicle.filter_step import QUANTITIES


def health_of(counts: Mapping[Quantity, tuple[int, int]], **others: Any) -> BufferHealth:
    """Return the health with how many of each quantity were accepted and rejected, and no others."""
    accepted, rejected = zip(*(counts.get(one, (0, 0)) for one in QUANTITIES), strict=True)
    facts = {"late": 0, "recoveries": 0, "nis_per_dof": None, "nis_dof": 0} | others
    return BufferHealth(accepted=accepted, rejected=rejected, **facts)
