from pathlib import Path

import pytest

from companion.config.integrity import ReceiverFrames
from link.errors import UserError
from scenarios.catalogue import catalogue
from scenarios.catalogue.catalogue import list_scenarios, load_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.simulation.drone import sim_autopilot_config
from scenarios.simulation.simulation import STEP_NS
from scenarios.tracks.config import MovingTrack
from tests.scenarios.presets import list_presets

ONE, AUTO, APART = ReceiverFrames.ONE, ReceiverFrames.AUTO, ReceiverFrames.APART


@pytest.mark.parametrize(("sensors", "frames"), [("rtk", ONE), ("report", ONE), ("nominal", AUTO), ("degraded", AUTO)])
def test_companion_is_told_of_receivers_in_one_frame_only(sensors: str, frames: ReceiverFrames) -> None:
    assert load_scenario(f"straight_5+sensors={sensors}").system.companion.integrity.receiver_frames is frames


def test_what_a_file_says_of_its_receivers_stays(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_text('base = "straight_5"\n[system.companion.integrity]\nreceiver_frames = "apart"\n', encoding="utf-8")
    assert load_scenario(str(path)).system.companion.integrity.receiver_frames is APART


@pytest.mark.parametrize(("sensors", "accuracy_m"), [("rtk", 0.01), ("nominal", 0.02), ("degraded", 1.2)])
def test_drones_receiver_states_how_well_the_drone_knows_its_place(sensors: str, accuracy_m: float) -> None:
    config = sim_autopilot_config(load_scenario(f"straight_5+sensors={sensors}"), 1, instant=True)
    assert config.own_state.receiver_accuracy_m == accuracy_m


BENCHMARK = [
    "static",
    *(f"straight_{speed}" for speed in (2, 5, 7, 10, 15, 20, 25, 30, 35)),
    *(f"report_{number}" for number in (1, 2, 3, 4)),
    "report_1_10",
    "report_3_10",
    *(f"figure_eight_{speed}" for speed in (4, 5, 7)),
    *(f"circle_{speed}" for speed in (3, 5, 8)),
    "stop_and_go_7",
    *(f"{track}_{speed}" for track in ("lane_change", "random") for speed in (5, 7)),
    "brake_7",
    "brake_10",
    *(f"rough_road_{speed}" for speed in (5, 8)),
    *(f"ship_ss{state}" for state in (4, 5, 6, 7)),
]


def test_catalogue_holds_the_benchmark() -> None:
    assert sorted(BENCHMARK) == [entry.name for entry in list_scenarios()]


@pytest.mark.parametrize("name", BENCHMARK)
def test_scenario_loads_under_its_name(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.run.waiting_point_enu_m[2] == (12.0 if name.startswith("ship") else 5.0)
    if isinstance(scenario.track, MovingTrack):
        assert name.endswith(f"_{int(scenario.track.speed_m_s)}")


def test_every_description_is_one_line_of_its_own() -> None:
    descriptions = [entry.description for entry in list_scenarios()]
    assert len(set(descriptions)) == len(descriptions)
    assert all(0 < len(text) < 100 and "\n" not in text for text in descriptions)


def test_antenna_to_pad_leads_from_the_antenna_to_the_roof() -> None:
    vehicle = load_scenario("straight_5").vehicle
    reached = [a + b for a, b in zip(vehicle.antenna_flu_m, vehicle.pad.antenna_to_pad_m, strict=True)]
    assert reached == pytest.approx([0.0, 0.0, 1.5])


@pytest.mark.parametrize("section", ["sensors", "wind", "link", "vehicle"])
def test_every_preset_fits_every_kind_of_track(section: str) -> None:
    for preset in list_presets(section):
        for name in ("static", "straight_5", "report_1"):
            assert load_scenario(f"{name}+{section}={preset}").name == f"{name}+{section}={preset}"


def test_every_option_that_is_listed_fits_behind_a_name() -> None:
    listed = [f"{section}={name}" for section, names in catalogue.list_presets().items() for name in names]
    assert {"firmware=ardupilot", "place=deck", "telemetry=none", "detector=model", "start=boot"} <= set(listed)
    for option in listed:
        # A drone that nothing tells of its vehicle needs sensors that see it.
        with_sensors = option if option.startswith("sensors=") else f"sensors=nominal+{option}"
        assert load_scenario(f"straight_5+{with_sensors}").name.endswith(option)


def test_world_that_is_misspelt_is_told() -> None:
    with pytest.raises(UserError, match="the nearest is 'world:urban'"):
        load_scenario("worldurban")


def test_preset_that_is_like_none_is_answered_by_all_that_there_are() -> None:
    with pytest.raises(UserError, match=r"is called 'good'; there are .*rtk"):
        load_scenario("straight_5+sensors=good")


def test_presets_in_a_name_replace_their_sections() -> None:
    scenario = load_scenario("circle_5+sensors=degraded+wind=moderate+link=nominal+firmware=px4")
    assert scenario.sensors.frame_offset_m == 1.2
    assert (scenario.wind.mean_m_s, scenario.wind.turbulence) == (10.0, "moderate")
    assert scenario.link.zenoh.delay_s == 0.03
    assert scenario.firmware == "px4"


@pytest.mark.slow
@pytest.mark.parametrize(("option", "can_arm"), [("", True), ("+start=boot", False)])
def test_autopilot_that_boots_is_not_there_within_its_first_second(option: str, can_arm: bool) -> None:
    lockstep = Lockstep(load_scenario(f"straight_5{option}"), 1)
    for _ in range(round(1e9 / STEP_NS)):
        lockstep.step()
    assert lockstep.companion.is_ready_to_start() is can_arm


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("straight_6", ["straight_6", "'straight_"]),
        ("figure_eigth_4", ["figure_eigth_4", "'figure_eight_4'"]),
        ("straight_5+sensors=nominel", ["nominel", "'nominal'"]),
        ("straight_5+sensor=nominal", ["sensor=nominal", "sensors"]),
        ("straight_5+firmware=inav", ["firmware", "inav"]),
        ("straight_5+wind=gust+link=nominal+wind=calm", ["names its wind twice", "leave one out"]),
        ("straight_5+start=boot+start=boot", ["names its start twice"]),
        ("nowhere.toml+firmware=px4", ["nowhere.toml", "cannot be read"]),
    ],
)
def test_wrong_name_is_one_line_that_names_what_is_near(name: str, words: list[str]) -> None:
    with pytest.raises(UserError) as caught:
        load_scenario(name)
    text = str(caught.value)
    assert "\n" not in text
    for word in words:
        assert word in text


def written(folder: Path, text: str) -> str:
    path = folder / "own.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_file_that_is_no_text_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "own.toml"
    path.write_bytes(b"name = '\xe9'")
    with pytest.raises(UserError, match=r"own.toml: not UTF-8 text$"):
        load_scenario(str(path))


def test_presets_behind_a_file_replace_its_sections(tmp_path: Path) -> None:
    folder = tmp_path / "straight_5+sensors=nominal"  # as a run's folder may be called
    folder.mkdir()
    path = written(folder, 'base = "straight_5"\n[track]\nspeed_m_s = 8.0\n')
    scenario = load_scenario(f"{path}+firmware=ardupilot+sensors=degraded")
    assert (scenario.name, scenario.firmware) == ("own+firmware=ardupilot+sensors=degraded", "ardupilot")
    assert scenario.sensors == load_scenario("straight_5+sensors=degraded").sensors
    assert isinstance(scenario.track, MovingTrack)
    assert scenario.track.speed_m_s == 8.0


def test_track_of_another_kind_takes_nothing_from_that_of_the_base(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        'base = "straight_5"\nwind = "gust"\n[track]\nkind = "waypoints"\n'
        "waypoints_m = [[-40.0, 0.0], [60.0, 5.0]]\nspeeds_m_s = [4.0, 6.0]\n",
    )
    scenario = load_scenario(str(path))
    assert scenario.track.kind == "waypoints"
    assert scenario.wind == load_scenario("straight_5+wind=gust").wind


def test_file_with_a_base_changes_what_it_names(tmp_path: Path) -> None:
    text = (
        'base = "straight_5"\n[track]\nspeed_m_s = 6.5\n[sensors]\npreset = "nominal"\n[sensors.fix]\nrate_hz = 20.0\n'
    )
    scenario = load_scenario(written(tmp_path, text))
    assert scenario.name == "own"
    assert isinstance(scenario.track, MovingTrack)
    assert (scenario.track.kind, scenario.track.speed_m_s) == ("straight", 6.5)
    assert (scenario.sensors.fix.rate_hz, scenario.sensors.fix.delay_s, scenario.sensors.frame_offset_m) == (
        20.0,
        0.06,
        0.5,
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('base = "straight_5"\n[track]\nspeed_km_h = 20.0\n', ["speed_km_h"]),
        ('base = "straight_5"\n[track]\nspeed_m_s = -1.0\n', ["speed_m_s", "-1.0"]),
        ('base = "straight_5"\n[wind]\nfrom_rad = 270.0\n', ["from_rad", "less than or equal to 3.14"]),
        (
            'base = "brake_7"\n[track]\nbrake_height_range_m = [2.0, 0.5]\n',
            ["brake_height_range_m", "the first number"],
        ),
        (
            'base = "straight_5"\n[track]\nroad_min_m = 10.0\nroad_s = 1.0\nspeed_m_s = 30.0\n',
            ["too short", "road_min_m"],
        ),
        (
            'base = "straight_5"\n[run]\ndrone_start_enu_m = [1e12, 0.0, 0.0]\n',
            ["run.drone_start_enu_m", "less than or equal to 10000"],
        ),
        (
            'base = "straight_5"\n[sensors.range_finder]\nmin_m = 5.0\nmax_m = 2.0\n',
            ["sensors.range_finder", "min_m must be less than max_m, 2"],
        ),
        ('base = "straight_5"\n[sensors.fix]\nrate_hz = 1e-300\n', ["sensors.fix.rate_hz", "at least 0.01"]),
        ('base = "straight"\n', ["'straight'", "'straight_"]),
        ('description = "no track"\n', ["track"]),
        ("speed = = 3\n", ["not valid TOML"]),
        (
            'base = "report_1"\n[track]\nspeeds_m_s = [0.0, 0.0]\n',
            ["speeds_m_s[0] and [1], at neighbouring waypoints, must not both be 0"],
        ),
    ],
)
def test_file_that_does_not_fit_is_one_line_that_names_the_key(tmp_path: Path, text: str, words: list[str]) -> None:
    with pytest.raises(UserError) as caught:
        load_scenario(written(tmp_path, text))
    message = str(caught.value)
    assert "\n" not in message
    for word in words:
        assert word in message
