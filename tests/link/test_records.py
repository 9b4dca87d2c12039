"""Records are what their constructors make, changed copies of them what `dataclasses.replace` makes."""

import dataclasses
from dataclasses import dataclass
from typing import Any

import pytest

from companion.landing.memory import Places, StepMemory
from link.messages import BodyTruth
from link.records import maker, replace

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


def test_copy_is_that_of_the_standard_library_and_the_original_stays() -> None:
    before = dataclasses.asdict(TRUTH)
    assert replace(TRUTH, t_ns=8, position_enu_m=(4.0, 5.0, 6.0)) == dataclasses.replace(
        TRUTH, t_ns=8, position_enu_m=(4.0, 5.0, 6.0)
    )
    assert dataclasses.asdict(TRUTH) == before


def test_fields_that_are_not_changed_are_handed_on_as_they_are() -> None:
    memory = StepMemory()
    changed = replace(memory, places=Places(origin_count=7))
    for field in dataclasses.fields(memory):
        assert field.name == "places" or getattr(changed, field.name) is getattr(memory, field.name)
    assert changed.places.origin_count == 7


def test_unknown_field_is_refused() -> None:
    unknown: dict[str, Any] = {"speed": 1.0}
    with pytest.raises(TypeError, match="BodyTruth has no field 'speed'"):
        replace(TRUTH, **unknown)


def test_record_that_is_checked_when_it_is_made_is_refused() -> None:
    with pytest.raises(TypeError, match=r"dataclasses\.replace"):
        replace(Checked(width_m=1.0, height_m=2.0), width_m=-1.0)


def test_made_record_is_that_of_its_constructor() -> None:
    made = maker(BodyTruth)(**{field.name: getattr(TRUTH, field.name) for field in dataclasses.fields(TRUTH)})
    assert made == TRUTH
    with pytest.raises(dataclasses.FrozenInstanceError):
        made.t_ns = 8  # type: ignore[misc]  # (that is what is tried)


def test_record_is_not_made_without_all_its_fields_nor_with_others() -> None:
    wrong: dict[str, Any]
    for wrong in ({"t_ns": 7}, dataclasses.asdict(TRUTH) | {"speed": 1.0}):
        with pytest.raises(TypeError, match="made"):
            maker(BodyTruth)(**wrong)


def test_maker_of_a_record_that_is_checked_when_it_is_made_is_refused() -> None:
    with pytest.raises(TypeError, match=r"dataclasses\.replace"):
        maker(Checked)
