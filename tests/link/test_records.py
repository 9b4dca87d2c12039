"""Records of both kinds are copied with what is changed; nobody can write in them, and none has a field too many."""

from dataclasses import dataclass
from typing import Any

import pytest

from companion.autopilots.frame_moves import FrameMoves
from companion.landing.state.memory import Places, StepMemory
from link.messages import BodyTruth
from link.records import replace

TRUTH = BodyTruth(
    t_ns=7,
    position_enu_m=(1.0, 2.0, 3.0),
    orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
    velocity_flu_m_s=(0.1, 0.2, 0.3),
    angular_velocity_flu_rad_s=(0.0, 0.0, 0.5),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Checked:
    width_m: float
    height_m: float

    def __post_init__(self) -> None:
        if self.width_m < 0.0:
            raise ValueError("negative")


def test_copy_has_what_is_changed_and_the_original_stays() -> None:
    copy = replace(TRUTH, t_ns=8, position_enu_m=(4.0, 5.0, 6.0))
    assert (copy.t_ns, copy.position_enu_m) == (8, (4.0, 5.0, 6.0))
    assert (TRUTH.t_ns, TRUTH.position_enu_m) == (7, (1.0, 2.0, 3.0))
    assert replace(copy, t_ns=7, position_enu_m=(1.0, 2.0, 3.0)) == TRUTH


def test_fields_that_are_not_changed_are_handed_on_as_they_are() -> None:
    memory = StepMemory()
    changed = replace(memory, places=Places(frame_moves=FrameMoves(origin_count=7)))
    for field in StepMemory.__struct_fields__:
        assert field == "places" or getattr(changed, field) is getattr(memory, field)
    assert changed.places.frame_moves.origin_count == 7


@pytest.mark.parametrize("record", [TRUTH, Checked(width_m=1.0, height_m=2.0)])
def test_unknown_field_is_refused(record: Any) -> None:
    with pytest.raises(TypeError, match="speed"):
        replace(record, speed=1.0)


@pytest.mark.parametrize(("record", "field"), [(TRUTH, "t_ns"), (Checked(width_m=1.0, height_m=2.0), "width_m")])
def test_nobody_writes_in_a_record(record: Any, field: str) -> None:
    with pytest.raises(AttributeError):
        setattr(record, field, 9)


def test_record_that_is_checked_when_it_is_made_is_checked_as_a_copy() -> None:
    with pytest.raises(ValueError, match="negative"):
        replace(Checked(width_m=1.0, height_m=2.0), width_m=-1.0)
