"""Recordings of PX4's and ArduCopter's own simulations, given to the link: all is understood, and the flight is seen.

`px4_offboard`: main of August 2025, arms and takes off in OFFBOARD, chases at 5 m/s, lands. `arducopter_guided`:
4.6.0-dev of November 2024, boots, arms and takes off in GUIDED, chases, lands in LAND. Both hold both directions.
"""

import lzma
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

from companion.autopilots.link import AutopilotLink
from link.mavlink.session import MavlinkSession
from tests.link.mavlink.tlog_frames import frames_of

pytestmark = pytest.mark.slow

DATA = Path(__file__).parents[1] / "data"
SYSTEM_ID = 1


class Moment(NamedTuple):
    """What the driver read; heights are rounded to metres."""

    armed: bool
    in_control: bool
    landed: bool | None
    taking_off: bool
    height_m: int | None


class Seen(NamedTuple):
    link: AutopilotLink
    moments: list[Moment]
    texts: list[str]


@cache
def _replayed(name: str) -> Seen:
    link, moments, texts = AutopilotLink(MavlinkSession(SYSTEM_ID)), list[Moment](), list[str]()
    for t_ns, frame in frames_of(lzma.decompress(DATA.joinpath(f"{name}.tlog.xz").read_bytes())):
        link.receive(frame, t_ns)
        link.poll(t_ns)
        texts += link.take_texts()
        view, own = link.state.view, link.state.own
        height_m = None if own is None else round(own.position_enu_m[2])
        moment = Moment(view.armed, view.in_control, view.landed, view.taking_off, height_m)
        if not moments or moments[-1][:4] != moment[:4]:
            moments.append(moment)
    return Seen(link, moments, texts)


@pytest.mark.parametrize("name", ["px4_offboard", "arducopter_guided"])
def test_recording_holds_nothing_that_the_session_does_not_understand(name: str) -> None:
    codec = _replayed(name).link.session.statistics.codec
    assert codec.messages_received > 10_000
    assert (codec.unknown_messages, codec.bad_frames, codec.bad_bytes, codec.lost_messages) == (0, 0, 0, 0)


def test_px4_is_seen_to_arm_take_off_land_and_disarm() -> None:
    assert _replayed("px4_offboard").moments == [
        Moment(armed=False, in_control=False, landed=None, taking_off=False, height_m=None),
        Moment(armed=False, in_control=False, landed=True, taking_off=False, height_m=None),
        Moment(armed=True, in_control=True, landed=True, taking_off=False, height_m=0),
        Moment(armed=True, in_control=True, landed=False, taking_off=False, height_m=0),
        Moment(armed=True, in_control=True, landed=True, taking_off=False, height_m=0),
        Moment(armed=False, in_control=True, landed=True, taking_off=False, height_m=0),
    ]


def test_arducopter_is_seen_to_arm_climb_by_itself_land_and_disarm() -> None:
    assert _replayed("arducopter_guided").moments == [
        Moment(armed=False, in_control=False, landed=None, taking_off=False, height_m=None),
        Moment(armed=False, in_control=False, landed=True, taking_off=False, height_m=None),
        Moment(armed=False, in_control=True, landed=True, taking_off=False, height_m=0),
        Moment(armed=True, in_control=True, landed=True, taking_off=False, height_m=0),
        Moment(armed=True, in_control=True, landed=False, taking_off=True, height_m=0),
        Moment(armed=True, in_control=True, landed=False, taking_off=False, height_m=5),
        Moment(armed=True, in_control=False, landed=False, taking_off=False, height_m=5),
        Moment(armed=True, in_control=False, landed=True, taking_off=False, height_m=0),
        Moment(armed=False, in_control=False, landed=True, taking_off=False, height_m=0),
    ]


def test_px4_is_read_to_lack_attitude_and_setpoints_while_it_boots() -> None:
    assert _replayed("px4_offboard").texts[:2] == ["modes attitude", "modes offboard signal"]


@pytest.mark.parametrize("name", ["px4_offboard", "arducopter_guided"])
def test_clock_and_origin_come_with_the_recording(name: str) -> None:
    link = _replayed(name).link
    assert link.session.clock.is_utc_known
    assert link.state.view.frame is not None
