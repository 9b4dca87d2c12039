from collections.abc import Sequence

from hypothesis import given
from hypothesis import strategies as st

from scenarios.falsify.minimal import minimal


@given(st.sets(st.integers(0, 39), max_size=6), st.integers(1, 40))
def test_what_is_needed_together_is_what_is_left(needed: set[int], count: int) -> None:
    items = list(range(count))
    wanted = needed & set(items)

    def still_fails(selections: Sequence[list[int]]) -> list[bool]:
        return [wanted <= set(selection) for selection in selections]

    assert minimal(items, still_fails) == sorted(wanted)


@given(st.sets(st.frozensets(st.integers(0, 9), min_size=1, max_size=4), min_size=1, max_size=4))
def test_of_what_is_left_no_single_item_can_be_left_out(causes: set[frozenset[int]]) -> None:
    def fails(selection: list[int]) -> bool:
        return any(cause <= set(selection) for cause in causes)

    kept = minimal(range(10), lambda selections: [fails(one) for one in selections])
    assert fails(kept)
    assert not any(fails([item for item in kept if item != left_out]) for left_out in kept)


def test_few_of_many_take_few_tries() -> None:
    tried = 0

    def still_fails(selections: Sequence[list[int]]) -> list[bool]:
        nonlocal tried
        tried += len(selections)
        return [{31, 77} <= set(selection) for selection in selections]

    assert minimal(range(100), still_fails) == [31, 77]
    assert tried < 60


def test_nothing_is_left_out_where_nothing_fails_any_more() -> None:
    assert minimal("abc", lambda selections: [False] * len(selections)) == ["a", "b", "c"]
