"""A flight's recording: complete, the same for the same seed, replayed exactly, and of no consequence to the flight."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

from companion.config.companion import CompanionConfig
from companion.recording.folder import recording_sink
from link.errors import UserError
from link.program.toml_config import merge, validate
from link.recording.mcap_reader import read_messages, recording_files, recordings
from link.recording.recorder import BackgroundRecorder
from link.zenoh.keys import Keys
from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.lockstep.run import run_in_lockstep
from scenarios.recordings.replay import Flight, read_flights, replay
from scenarios.recordings.result import result_table
from scenarios.recordings.run_folder import RunOptions
from scenarios.reports.figure_files import save_all
from scenarios.reports.figures import draw_figures, figures_of
from scenarios.reports.html_report import write_report
from scenarios.reports.run_data import read_run
from scenarios.reports.run_shown import distances, heights
from scenarios.view.recorded import RecordedSource

pytestmark = pytest.mark.slow
SCENARIO = "straight_5+sensors=nominal"
PAGE_MAX = 2_000_000  # characters


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    options = RunOptions(seed=2, speed=1.0, folder=folder, record=True)
    run_in_lockstep(load_scenario(SCENARIO), options, lambda *_: None)
    return folder


@pytest.fixture(scope="module")
def flight(run: Path) -> Flight:
    ((_, flight),) = read_flights(run)
    return flight


def test_every_topic_of_a_run_is_decoded_by_an_independent_reader(run: Path) -> None:
    counts: dict[str, int] = {}
    for file in [*recording_files(run, "companion"), *recording_files(run, "truth")]:
        with AnyReader([file]) as reader:
            for connection, _, raw in reader.messages():
                reader.deserialize(raw, connection.msgtype)
                counts[connection.topic] = counts.get(connection.topic, 0) + 1
    named = {name.removeprefix("/decklander/") for name in counts}
    assert named >= {"vehicle/fix", "vehicle/truth", "drone/truth", "drone/truth/rotors"}
    inside = ("input", "own", "step", "setpoint", "estimate", "forecast", "forecast_path", "plan", "plan_path", "link")
    assert named >= {f"drone/companion/{name}" for name in (*inside, "scene", "location")} | {"/tf"}
    assert counts.pop("/decklander/drone/companion/log") >= 6  # a line for each phase
    assert min(counts.values()) > 10


def test_recording_stands_in_utc_from_its_first_message(run: Path) -> None:
    times_ns = [recorded.log_ns for recorded in read_messages(recording_files(run, "companion"))]
    assert (max(times_ns) - min(times_ns)) * 1e-9 < 60.0


def test_replay_of_the_same_version_equals_the_flight_in_every_field(flight: Flight) -> None:
    result = replay(flight)
    assert result.steps > 500
    assert result.fields > 20_000
    assert result.differences == ()
    assert result.missing_inputs == 0


def test_companion_that_was_started_again_leaves_two_flights_that_are_replayed_apart(run: Path, tmp_path: Path) -> None:
    (file,) = recording_files(run, "companion")
    for name in ("companion_000.mcap", "companion_2_000.mcap"):
        shutil.copy(file, tmp_path / name)
    flights = dict(read_flights(tmp_path))
    names = [f"{tmp_path.name}/companion_000.mcap", f"{tmp_path.name}/companion_2_000.mcap"]
    assert list(flights) == names
    first, second = flights.values()
    assert first.inputs == second.inputs


def test_replay_with_another_gain_names_the_fields_largest_difference_first(flight: Flight) -> None:
    table = merge(flight.config.model_dump(mode="json"), {"descent": {"sink": {"gain_hz": 1.1}}})
    result = replay(flight, validate(CompanionConfig, table, source="test"))
    named = [one.field for one in result.differences]
    assert "setpoint.position_m" in named
    assert "step.next_velocity_m_s" in named
    assert "estimate.position_m" not in named
    assert "own.pose.pose.position.x" not in named
    sizes = [one.largest for one in result.differences]
    assert sizes == sorted(sizes, reverse=True)


def test_recording_is_the_same_for_the_same_seed(run: Path, tmp_path: Path) -> None:
    options = RunOptions(seed=2, speed=1.0, folder=tmp_path, record=True)
    run_in_lockstep(load_scenario(SCENARIO), options, lambda *_: None)
    for name in ("companion_000.mcap", "truth_000.mcap", "result.json"):
        assert run.joinpath(name).read_bytes() == tmp_path.joinpath(name).read_bytes()


def test_approach_of_a_run_ends_with_the_touchdown(run: Path) -> None:
    result = json.loads(run.joinpath("result.json").read_text(encoding="utf-8"))
    (approach,) = result["approaches"]
    assert (approach["ended"], approach["reason_code"], approach["begun_anew"]) == ("touchdown", "CONTACT", [])
    assert approach["from_s"] == result["phases_s"]["chase"]
    assert approach["to_s"] == pytest.approx(result["contact_s"], abs=0.5)
    assert approach["lowest_m"] == pytest.approx(0.0, abs=0.03)
    assert result["ended_reason_code"] == "MOTORS_OFF"
    # It waits at the scenario's own waiting point, to some decimetres.
    assert result["pass_to_contact_s"] == pytest.approx(result["time_to_contact_s"], abs=0.2)


def test_figures_of_a_run_are_drawn_in_both_forms_and_twice_the_same(run: Path, tmp_path: Path) -> None:
    once = {file.name: file.read_bytes() for file in draw_figures(run, tmp_path / "once")}
    stems = {"path_3d", "path_above", "motion", "funnel", "touchdown", "estimate"}
    assert set(once) == {f"{stem}.{form}" for stem in stems for form in ("png", "svg")}
    again = save_all({"funnel": figures_of(run)["funnel"]}, tmp_path / "again")
    assert [file.read_bytes() for file in again] == [once["funnel.png"], once["funnel.svg"]]


def test_run_as_arrays_agrees_with_its_result(run: Path) -> None:
    data = read_run(run)
    contact = int(np.searchsorted(data.t_s, data.result["contact_s"]))
    assert distances(data)[contact] == pytest.approx(data.result["horizontal_error_m"], abs=0.02)
    assert heights(data)[contact] == pytest.approx(0.0, abs=0.05)
    assert data.phases[-1].phase == "secured"
    assert data.estimate is not None
    assert float(np.median(np.abs(data.estimate.error_m[-50:, 2]))) < 0.5


def test_page_about_a_run_needs_nothing_from_elsewhere(run: Path, tmp_path: Path) -> None:
    page = write_report(run, tmp_path / "report.html").read_text(encoding="utf-8")
    assert len(page) < PAGE_MAX
    for fetched in ('src="http', "src='http", '<link rel="stylesheet"', "@import"):
        assert fetched not in page
    for told in (
        "S3: landed",
        "gain_hz",
        "numpy",
        "<code>CONTACT</code>",
        "px4, seed 2",
        "<svg",
    ):
        assert told in page


def test_folder_without_a_recording_is_told(tmp_path: Path) -> None:
    result = {"scenario": SCENARIO, "seed": 1, "tier": "abort", "reason": "never took off"}
    tmp_path.joinpath("result.json").write_text(json.dumps(result), encoding="utf-8")
    with pytest.raises(UserError, match="holds no recording"):
        draw_figures(tmp_path, None)


def test_file_in_place_of_its_folder_is_told_which_folder_to_name(tmp_path: Path) -> None:
    file = tmp_path / "companion_000.mcap"
    file.touch()
    with pytest.raises(UserError, match=f"name its folder {tmp_path}"):
        recordings(file, "companion")


def test_full_disk_costs_records_and_changes_nothing_of_the_landing(run: Path, small_disk: Path) -> None:
    scenario = load_scenario(SCENARIO)
    recorder = BackgroundRecorder(recording_sink(small_disk, scenario.system.companion, Keys()))
    lockstep = Lockstep(scenario, 2, recorder=recorder)
    ended = lockstep.run()
    recorder.close()
    whole = json.loads(run.joinpath("result.json").read_text(encoding="utf-8"))
    result = result_table(scenario, 2, lockstep.recording, ended)
    assert result["tier"] == whole["tier"] == "S3"
    assert result["horizontal_error_m"] == whole["horizontal_error_m"]
    assert recorder.dropped > 100
    assert sum(1 for _ in read_messages(recording_files(small_disk, "companion"))) > 100


def test_run_into_a_full_folder_ends_in_one_line_that_says_what_to_change(small_disk: Path) -> None:
    scenario = load_scenario(SCENARIO).with_run(time_limit_s=1.5)
    options = RunOptions(seed=2, speed=1.0, folder=small_disk, record=True)
    with pytest.raises(UserError, match=r"result\.json: cannot be written \(.+\); make room") as told:
        run_in_lockstep(scenario, options, lambda *_: None)
    assert "\n" not in str(told.value)


def test_view_of_a_recording_has_the_motion_the_phases_and_the_road(run: Path, flight: Flight) -> None:
    source = RecordedSource(run)
    source.playing = True
    source.advance(0.0)
    phases_s = json.loads(run.joinpath("result.json").read_text(encoding="utf-8"))["phases_s"]
    amid_s = 0.5 * (phases_s["chase"] + phases_s["align"])
    amid = source.advance(amid_s)
    assert source.position_s == pytest.approx(amid_s)
    end = source.advance(10.0 * source.duration_s)
    assert source.position_s == source.duration_s
    assert amid.status is not None
    assert end.status is not None
    assert (amid.status.phase, end.status.phase) == ("chase", "secured")
    assert all(value is not None for value in (amid.drone_truth, amid.estimate, amid.forecast, amid.pad))
    assert amid.link is not None
    assert 0 < amid.link.messages_received < flight.inputs[-1].sequence
    assert source.road is not None
    assert source.road.seed == 2


def test_view_of_a_real_flight_needs_no_truth(run: Path, tmp_path: Path) -> None:
    for file in recording_files(run, "companion"):
        shutil.copy(file, tmp_path)
    source = RecordedSource(tmp_path)
    source.playing = True
    source.advance(0.0)
    end = source.advance(source.duration_s)
    assert (source.road, end.drone_truth) == (None, None)
    assert end.pad is not None
    assert end.drone is not None
    assert np.isfinite(source.history.pad[-1]).all()
