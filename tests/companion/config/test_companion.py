"""The configuration: what a file may say, and that a mistake in it is named."""

from pathlib import Path

import pytest

from companion.config.companion import CompanionConfig
from link.errors import UserError
from link.program.toml_config import dump_toml, load_config


def _file(folder: Path, text: str) -> Path:
    path = folder / "companion.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_printed_configuration_reads_back_as_the_same(tmp_path: Path) -> None:
    config = CompanionConfig()
    assert load_config(_file(tmp_path, dump_toml(config)), CompanionConfig) == config


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("[abort]\nretries = 1\n", "retries"),
        ("[abort]\nretries_max = -1\n", "retries_max"),
        ("[abort]\nfix_age_max_s = 0.0\n", "fix_age_max_s"),
        ("[limits]\nspeed_max_m_s = nan\n", "speed_max_m_s"),
        ("[limits]\nspeed_max_m_s = inf\n", "speed_max_m_s"),
        ("[limits]\nspeed_max_m_s = 0.05\n", "speed_max_m_s"),
        ("[limits]\nclimb_max_m_s = 1e-9\n", "climb_max_m_s"),
        ("[limits]\nvertical_acceleration_max_m_s2 = 1e-9\n", "vertical_acceleration_max_m_s2"),
        ("[limits]\nvertical_jerk_max_m_s3 = 0.9\n", "vertical_jerk_max_m_s3"),
        ("[chase]\nparked_speed_m_s = 50.0\n", "parked_speed_m_s"),
        ("[chase]\nparked_speed_stds = 1e4\n", "parked_speed_stds"),
        ("[chase]\ndriving_hold_s = 1e4\n", "driving_hold_s"),
        ("[sortie.launch]\nclear_height_m = 0.5\n", "clear_height_m"),
        ("[sortie]\nkeep_out_stds = 1e4\n", "keep_out_stds"),
        ("[setpoints]\nrate_hz = 0.0\n", "rate_hz"),
        ("[estimator.imm.sway]\ntilt_std_rad = 1e-300\n", "tilt_std_rad"),
        ("[estimator.imm.easing]\nbegins_after_s = 1e-300\n", "begins_after_s"),
        ("[guidance.mpc]\njerk_weight = 1e-300\n", "jerk_weight"),
        ("[guidance.mpc]\nintercept_time_min_s = 1e6\n", "intercept_time_min_s"),
        ("[guidance.mpc]\ntouch_time_s = 1e6\n", "touch_time_s"),
        ("[descent]\ncommit_height_m = 'low'\n", "commit_height_m"),
        ("[landing]\nheight_m = 1.0\n", "landing"),
        ("[silent_vehicle]\n[estimator]\nkind = 'ukf'\n", "silent_vehicle"),
    ],
)
def test_mistake_is_one_line_that_names_file_and_key(tmp_path: Path, text: str, key: str) -> None:
    path = _file(tmp_path, text)
    with pytest.raises(UserError) as error:
        load_config(path, CompanionConfig)
    assert key in str(error.value)
    assert path.name in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[takeoff]\nrefused_after_s = 90.0\n", r"takeoff\.time_limit_s = 60\.0 .* more than refused_after_s, 90"),
        (
            "[takeoff]\nwaiting_height_m = 0.3\n",
            r"takeoff\.reached_distance_m = 0\.5 .* less than waiting_height_m, 0\.3",
        ),
        ("[takeoff]\ntime_limit_s = 30.0\n", r"takeoff\.time_limit_s = 30\.0 .* more than refused_after_s, 30"),
        (
            "[touchdown]\npress_acceleration_m_s2 = 3.0\n",
            r"touchdown\.press_acceleration_m_s2 = 3\.0 .* more than falling_acceleration_m_s2, 3\.5",
        ),
        (
            "[touchdown]\nfalling_acceleration_m_s2 = 6.0\n",
            r"touchdown\.try_acceleration_m_s2 = 5\.0 .* more than falling_acceleration_m_s2, 6",
        ),
        ("[touchdown]\njolt_m_s2 = 3.0\n", r"touchdown\.jolt_m_s2 = 3\.0 .* at least 9\.81"),
        ("[guidance.mpc]\nmoves_s = []\n", r"guidance\.mpc .* 1 to 40 blocks, .* not 0 and 0"),
        ("[guidance.mpc]\nmoves_s = [1000.0]\n", r"guidance\.mpc .* at most 200 nodes, not 1 and 6250"),
        (f"[guidance.mpc]\nmoves_s = {[0.02] * 41}\n", r"guidance\.mpc .* 1 to 40 blocks, .* not 41 and 41"),
        ("[guidance.mpc]\nmoves_s = [1e-12]\n", r"moves_s\[0\] = 1e-12"),
        ("[guidance.mpc]\nnode_spacing_max_s = 1e-6\n", r"node_spacing_max_s = 1e-06 .* at least 0\.01"),
        ("[descent]\ncommit_height_m = 0.7\n", r"commit_height_m, 0\.7, must be less than the heights of wait, 0\.7"),
        (
            "[estimator.imm.sway]\nfrequency_hz = 0.5\n",
            r"estimator\.imm\.sway .* frequency_min_hz must not be above frequency_hz, 0\.5",
        ),
        ("[estimator.imm.sway]\nfrequency_min_hz = 0.1\n", r"frequency_min_hz = 0\.1 .* at least 0\.25"),
    ],
    ids=[
        "refusal never told",
        "waiting point on the ground",
        "time limit too short",
        "press is no fall",
        "fall harder than the press",
        "a jolt of any flight",
        "no moves",
        "moves too long",
        "too many moves",
        "move too short",
        "nodes too near",
        "commit above the wait",
        "slowest sway above the first",
        "sway slower than it is watched for",
    ],
)
def test_numbers_that_do_not_go_together_are_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(UserError, match=said) as error:
        load_config(_file(tmp_path, text), CompanionConfig)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "text", ["total_max_mb = 100.0\n", "file_max_mb = 3000.0\n", "file_max_mb = 50\ntotal_max_mb = 49"]
)
def test_recording_whose_files_together_may_take_less_than_one_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(UserError, match=r"companion\.toml: recording\.total_max_mb = .* file_max_mb") as error:
        load_config(_file(tmp_path, f"[recording]\n{text}"), CompanionConfig)
    assert "\n" not in str(error.value)


def test_recording_of_one_file_only_is_taken(tmp_path: Path) -> None:
    config = load_config(_file(tmp_path, "[recording]\ntotal_max_mb = 256.0\n"), CompanionConfig)
    assert config.recording.total_max_mb == config.recording.file_max_mb


def test_thresholds_of_the_landing_are_in_order() -> None:
    config = CompanionConfig()
    assert config.descent.sink.contact_rate_m_s < config.descent.sink.rate_max_m_s <= config.limits.descent_max_m_s
    assert config.descent.commit_height_m < config.descent.alignment.height_m <= config.chase.height_m
    assert config.touchdown.height_max_m < config.touchdown.lost.height_m < config.abort.height_m
    assert config.touchdown.blocked_depth_m < config.descent.sink.press_depth_m
    assert config.descent.wait.centred_distance_m < config.descent.alignment.begin_distance_m
