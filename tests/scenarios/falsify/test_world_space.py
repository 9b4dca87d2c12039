import pytest

from scenarios.falsify.aim import Aim
from scenarios.falsify.world_space import world_space
from scenarios.worlds.odd import slices
from scenarios.worlds.world import draw_world


def aim_of(slice_name: str) -> Aim:
    aim = world_space(slice_name, 1).aim
    assert aim is not None
    return aim


@pytest.mark.parametrize("slice_name", slices())
def test_first_event_is_a_brake_that_begins_when_it_is_aimed(slice_name: str) -> None:
    aim = aim_of(slice_name)
    for seed, begins_s in ((11, 0.7), (12, 5.2), (13, 23.0)):
        event = aim.at(seed, {}, begins_s)
        assert event is not None
        drawn = draw_world(slice_name, seed, chosen=event).drawn
        began_s = float(drawn["drive.first_event_s"]) - float(drawn["drive.passes_s"])
        assert began_s == pytest.approx(begins_s, abs=1e-6)
        assert int(drawn["drive.brakes"]) >= 1


@pytest.mark.parametrize("begins_s", [-0.1, 0.0, 121.0])
def test_brake_that_no_world_has_is_not_aimed(begins_s: float) -> None:
    assert aim_of("world:urban").at(11, {}, begins_s) is None


def test_quantities_that_are_not_searched_are_at_their_medians() -> None:
    space = world_space("world:yard", 5, ["driver", "wind"])
    median = world_space("world:yard", 5, ["wind"])
    assert space.draw(5, {"wind.mean_m_s": 0.9}) == median.draw(5, {"wind.mean_m_s": 0.9})
    assert {name.partition(".")[0] for name in space.names} == {"driver", "wind"}


@pytest.mark.parametrize(("only", "aims"), [(["driver"], True), (["wind", "link"], False), ([], True)])
def test_events_are_aimed_where_the_driver_is_searched(only: list[str], aims: bool) -> None:
    assert (world_space("world", 5, only).aim is not None) == aims
