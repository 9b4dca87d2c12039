"""Liveliness tokens as they are kept: as many as there may be, and no more."""

from contextlib import closing

from link.zenoh.inbox import Alive, WakeUp


def test_tokens_of_a_flood_are_not_kept_beyond_a_hundred_and_a_lost_one_makes_room() -> None:
    with closing(WakeUp()) as wake_up:
        alive = Alive(wake_up)
        for number in range(10_000):
            alive.update(f"ns/drone/companion/alive/{number}", is_alive=True)
        assert len(alive.keys) == 100
        alive.update("ns/drone/companion/alive/7", is_alive=False)
        alive.update("ns/drone/companion/alive/late", is_alive=True)
        assert "ns/drone/companion/alive/late" in alive.keys
