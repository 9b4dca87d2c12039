"""A recording's transforms and scene, decoded by the schemas that the file carries, beside the simulation's truth.

The companion draws in the autopilot's local frame, so the truth is laid out in that first (`link.frames.geodesy`).
"""

from math import cos, exp, sin
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from numpy.typing import NDArray

from link.frames.geodesy import LocalFrame, Projection, geodetic_from_enu, local_from_geodetic
from link.recording.mcap_reader import recording_files
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import VehicleConfig
from scenarios.lockstep.run import run_in_lockstep
from scenarios.recordings.run_folder import RunOptions
from scenarios.simulation.vehicle_node import datum_of
from sim_autopilot.runtime.config import DatumConfig

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]

SCENARIO = "circle_5"  # with an exact state of the drone; the vehicle's receiver, which has no heading:
FIX_STD_M, VELOCITY_STD_M_S, SPEED_M_S = 0.02, 0.05, 5.0
VEHICLE = VehicleConfig()
SINGLE_M = 2.0**-15
"""Of LOCAL_POSITION_NED up to 256 m: half a unit in the last place, of three axes and with the turn into W."""
CHART_M = 20.0**2 / (2.0 * 6.37e6)
"""By which the stand-in's linear map of the globe is off at its reach (`sim_autopilot.core.places`)."""
SINGLE_RAD = 4.0 * 2.0**-23
"""Of ATTITUDE_QUATERNION: a unit in the last place of each of its four numbers."""
BEYOND_3_STD = exp(-4.5)
"""Of a plane normal distribution."""
CHASE_S = 5.0
"""The last part of the flight, in which the vehicle was followed for as long as it takes to know it."""


class Track(NamedTuple):
    """Times, ns since the first truth, places (n, 3) in the autopilot's frame and attitudes (n, 4), wxyz."""

    t_ns: Array
    places_m: Array
    attitudes: Array

    def at(self, t_ns: Array) -> Array:
        """The places in between."""
        return np.column_stack([np.interp(t_ns, self.t_ns, self.places_m[:, axis]) for axis in range(3)])


class Shown(NamedTuple):
    """What was read of a recording."""

    truth: dict[str, Track]
    transforms: dict[str, Track]
    scenes: list[Any]
    first_ns: int


def stamp_ns(stamp: Any) -> int:
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)


def track_of(poses: list[tuple[int, Any, Any]], first_ns: int) -> Track:
    return Track(
        np.array([t_ns - first_ns for t_ns, _, _ in poses], float),
        np.array([(place.x, place.y, place.z) for _, place, _ in poses]),
        np.array([(turn.w, turn.x, turn.y, turn.z) for _, _, turn in poses]),
    )


def angles_rad(one: Array, other: Array) -> Array:
    return np.asarray(2.0 * np.arccos(np.minimum(1.0, np.abs(np.sum(one * other, axis=1)))))


def in_local_frame(track: Track) -> Track:
    datum = datum_of(DatumConfig())
    frame = LocalFrame(origin=datum, projection=Projection.PX4)
    places = [local_from_geodetic(frame, *geodetic_from_enu(datum, (x, y, z))) for x, y, z in track.places_m.tolist()]
    return track._replace(places_m=np.array(places))


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> Shown:
    folder = tmp_path_factory.mktemp("run")
    options = RunOptions(seed=2, speed=1.0, folder=folder, record=True)
    run_in_lockstep(load_scenario(SCENARIO), options, lambda *_: None)
    return read(folder)


def read(folder: Path) -> Shown:
    truth: dict[str, list[tuple[int, Any, Any]]] = {}
    transforms: dict[str, list[tuple[int, Any, Any]]] = {}
    scenes = []
    for file in [*recording_files(folder, "truth"), *recording_files(folder, "companion")]:
        with file.open("rb") as stream:
            for _, channel, _, message in make_reader(
                stream, decoder_factories=[DecoderFactory()]
            ).iter_decoded_messages():
                if channel.topic.endswith("/truth"):
                    pose = message.pose.pose
                    of = truth.setdefault(channel.topic.split("/")[-2], [])
                    of.append((stamp_ns(message.header.stamp), pose.position, pose.orientation))
                elif channel.topic == "/tf":
                    for one in message.transforms:
                        placed = one.transform.translation, one.transform.rotation
                        transforms.setdefault(one.child_frame_id, []).append((stamp_ns(one.header.stamp), *placed))
                elif channel.topic.endswith("/scene"):
                    scenes.append(message)
    first_ns = truth["drone"][0][0]
    return Shown(
        {name: in_local_frame(track_of(poses, first_ns)) for name, poses in truth.items()},
        {name: track_of(poses, first_ns) for name, poses in transforms.items()},
        scenes,
        first_ns,
    )


def test_drone_stands_where_it_truly_was_at_its_stamp(shown: Shown) -> None:
    truth, drawn = shown.truth["drone"], shown.transforms["base_link"]
    rows = np.searchsorted(truth.t_ns, drawn.t_ns)
    known = rows < len(truth.t_ns)
    rows, places, attitudes = rows[known], drawn.places_m[known], drawn.attitudes[known]
    assert len(rows) > 1000
    assert np.array_equal(truth.t_ns[rows], drawn.t_ns[known])  # the truth is recorded with each state
    assert np.abs(places - truth.places_m[rows]).max() < SINGLE_M + CHART_M
    in_a_tick_rad = angles_rad(truth.attitudes[1:], truth.attitudes[:-1]).max()  # place and attitude come one by one
    assert angles_rad(attitudes, truth.attitudes[rows]).max() <= in_a_tick_rad + SINGLE_RAD


def test_vehicle_stands_as_near_to_its_true_place_as_its_receiver_can_tell(shown: Shown) -> None:
    truth, drawn = shown.truth["vehicle"], shown.transforms["vehicle"]
    late = (drawn.t_ns <= truth.t_ns[-1]) & (drawn.t_ns > truth.t_ns[-1] - CHASE_S * 1e9)
    off_m = np.linalg.norm((drawn.places_m[late] - truth.at(drawn.t_ns[late]))[:, :2], axis=1)
    lever_m = float(np.hypot(*VEHICLE.antenna_flu_m[:2]))
    heading_std_rad = VELOCITY_STD_M_S / SPEED_M_S  # of the course of one velocity
    std_m = float(np.hypot(FIX_STD_M, lever_m * heading_std_rad))
    assert len(off_m) > 20
    assert np.sqrt(np.mean(off_m**2)) < np.sqrt(2.0) * std_m  # no worse than one fix and one velocity, on two axes


def test_forecast_ellipses_hold_where_the_antenna_truly_came_to_be(shown: Shown) -> None:
    truth = shown.truth["vehicle"]
    yaw_rad = 2.0 * np.arctan2(truth.attitudes[:, 3], truth.attitudes[:, 0])
    x_m, y_m, _ = VEHICLE.antenna_flu_m
    antenna = truth._replace(
        places_m=truth.places_m
        + np.array([(x_m * cos(a) - y_m * sin(a), x_m * sin(a) + y_m * cos(a), 0.0) for a in yaw_rad.tolist()])
    )
    stds = []
    for scene in shown.scenes:
        for entity in (one for one in scene.entities if one.id == "forecast"):
            _, *rings = entity.lines
            for ahead_s, ring in enumerate(rings):
                t_ns = float(stamp_ns(entity.timestamp) - shown.first_ns) + ahead_s * 1e9
                if t_ns <= antenna.t_ns[-1]:
                    outline = np.array([(point.x, point.y) for point in ring.points])
                    low, high = outline.min(axis=0), outline.max(axis=0)
                    off = antenna.at(np.array([t_ns]))[0, :2] - 0.5 * (low + high)
                    stds.append(float(np.linalg.norm(off / (0.5 * (high - low)))))
    assert len(stds) > 500
    assert np.mean(np.array(stds) > 3.0) <= BEYOND_3_STD


def test_pad_is_drawn_on_the_roof_in_its_size(shown: Shown) -> None:
    (vehicle,) = (one for one in shown.scenes[-1].entities if one.id == "vehicle")
    tops = {(one.size.x, one.size.y): one.pose.position.z + 0.5 * one.size.z for one in vehicle.cubes}
    assert tops[VEHICLE.pad_size_m] == pytest.approx(VEHICLE.roof_height_m)
    assert np.ptp(shown.transforms["pad"].places_m, axis=0).max() == 0.0
    assert shown.transforms["pad"].places_m[0].tolist() == [0.0, 0.0, VEHICLE.roof_height_m]
