"""The keys are those of the contract, and names that Zenoh would read otherwise are refused."""

import pytest

from link.errors import UserError
from link.zenoh.keys import Keys


def test_keys_are_those_of_the_contract() -> None:
    keys = Keys("decklander", "van", "hawk")
    assert (keys.fix, keys.fix_velocity, keys.imu) == (
        "decklander/van/fix",
        "decklander/van/fix_velocity",
        "decklander/van/imu",
    )
    assert (keys.alive, keys.pad, keys.pad_pose) == (
        "decklander/van/alive",
        "decklander/van/pad",
        "decklander/hawk/pad_pose",
    )
    assert (keys.landing_status, keys.landing_plan, keys.landing_command) == (
        "decklander/hawk/landing/status",
        "decklander/hawk/landing/plan",
        "decklander/hawk/landing/command",
    )
    assert (keys.clock, keys.vehicle_truth, keys.drone_truth, keys.drone_rotors) == (
        "decklander/clock",
        "decklander/van/truth",
        "decklander/hawk/truth",
        "decklander/hawk/truth/rotors",
    )


def test_a_namespace_may_have_several_parts() -> None:
    assert Keys("site/north", "v", "d").clock == "site/north/clock"


@pytest.mark.parametrize("name", ["", "/a", "a/", "a//b", "a/*", "**", "a$*", "a?x", "a#b", "@a", "a b", "a\n"])
def test_a_namespace_that_zenoh_would_not_take_literally_is_refused(name: str) -> None:
    with pytest.raises(UserError, match="--ns"):
        Keys(name, "vehicle", "drone")


def test_a_vehicle_is_one_part() -> None:
    with pytest.raises(UserError, match="--vehicle 'a/b' holds '/'"):
        Keys("ns", "a/b", "drone")


def test_vehicle_and_drone_must_differ() -> None:
    with pytest.raises(UserError, match="different names"):
        Keys("ns", "same", "same")
