"""What a program does before it keeps time with a clock."""

import gc
from collections.abc import Iterator
from weakref import ref

import pytest

from link.program.clock import spare_present_objects


class Knot:
    """Refers to itself, so that only a collection of garbage removes it."""

    def __init__(self) -> None:
        self.itself = self


@pytest.fixture(autouse=True)
def thawed() -> Iterator[None]:
    yield
    gc.unfreeze()


def test_later_collections_look_at_later_objects_only() -> None:
    before = Knot()
    spare_present_objects()
    later = Knot()
    looked_at = {id(one) for one in gc.get_objects()}
    assert id(before) not in looked_at
    assert id(later) in looked_at


def test_garbage_of_later_goes() -> None:
    spare_present_objects()
    later = ref(Knot())
    gc.collect()
    assert later() is None
