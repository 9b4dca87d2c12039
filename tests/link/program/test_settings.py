"""Single settings: by the command line and by the environment."""

from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.companion import CompanionConfig
from link.errors import UserError
from link.program.settings import (
    COMPANION,
    SIM_AUTOPILOT,
    load_settings,
    settings_of_environment,
    settings_of_options,
    without_settings,
)
from sim_autopilot.runtime.config import SimAutopilotConfig

VARIABLE = "DECKLANDER_COMPANION__DESCENT__CONE__SLOPE"


def load(*given: str, path: Path | None = None, above: dict[str, Any] | None = None) -> CompanionConfig:
    return load_settings(path, CompanionConfig, COMPANION, given, above)


@pytest.mark.parametrize(
    "name", ["DECKLANDER_COMPANON__LIMITS__SPEED_MAX_M_S", "DECKLANDER_COMPANION_LIMITS_SPEED_MAX_M_S"]
)
def test_variable_that_would_set_nothing_is_refused_with_what_it_should_begin_with(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(name, "5.0")
    with pytest.raises(UserError, match=rf"{name} sets nothing: it must begin with DECKLANDER_COMPANION__,"):
        load()


def test_environment_stands_above_the_file_and_the_command_line_above_both(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "companion.toml"
    path.write_text("[descent.cone]\nslope = 0.1\nradius_at_pad_m = 0.2\n", encoding="utf-8")
    assert load(path=path).descent.cone.slope == 0.1
    monkeypatch.setenv(VARIABLE, "0.2")
    assert load(path=path).descent.cone.slope == 0.2
    changed = load("descent.cone.slope=0.3", path=path).descent.cone
    assert (changed.slope, changed.radius_at_pad_m) == (0.3, 0.2)


def test_what_the_environment_sets_is_told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    load()
    assert not capsys.readouterr().err
    monkeypatch.setenv(VARIABLE, "0.2")
    load()
    assert capsys.readouterr().err == f"configuration: set by the environment: {VARIABLE}\n"


def test_option_of_its_own_stands_above_set() -> None:
    assert load("autopilot.kind=px4", above={"autopilot": {"kind": "ardupilot"}}).autopilot.kind.value == "ardupilot"


@pytest.mark.parametrize(
    ("text", "value"),
    [("3", 3), ("0.5", 0.5), ("true", True), ("mpc", "mpc"), ('"3"', "3"), ("[1.0, 2.0]", [1.0, 2.0]),
     ("a = 1", "a = 1"), ("", ""), ("1\nb = 2", "1\nb = 2"), ("a=b", "a=b")],
)  # fmt: skip
def test_value_is_read_as_toml_and_a_bare_word_as_text(text: str, value: object) -> None:
    assert settings_of_options([f"one.two={text}"]) == {"one": {"two": value}}


@given(st.lists(st.from_regex(r"[a-z_]{1,8}", fullmatch=True), min_size=1, max_size=4), st.floats(-1e9, 1e9))
def test_any_dotted_key_becomes_its_table(parts: list[str], number: float) -> None:
    table: Any = settings_of_options([f"{'.'.join(parts)}={number!r}"])
    for part in parts:
        table = table[part]
    assert table == number


@pytest.mark.parametrize("text", ["descent", "=3", "descent.=3", ".slope=3"])
def test_what_is_no_key_and_value_is_told_how_to_write_it(text: str) -> None:
    with pytest.raises(UserError, match="is no KEY=VALUE; write it as"):
        settings_of_options([text])


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        (f"{'.'.join('a' * 3000)}=1", r"^--set a\.a\..*\.\.\.: has 3000 parts, and no setting has more than 20$"),
        ("descent.cone.slope=\udcff\udcfe", r"^--set descent\.cone\.slope: is not UTF-8; write it in UTF-8$"),
        ("descent.c\udcff=1", r"^--set descent\.c\udcff: is not UTF-8"),
        (f"descent={{{'.'.join('a' * 3000)}=1}}", r"^command line: descent = .* does not fit"),
        (f"descent.cone.slope=0x{'f' * 5000}", r"^command line: descent\.cone\.slope = .* does not fit"),
    ],
)
def test_setting_that_is_none_of_a_configuration_is_one_line(setting: str, told: str) -> None:
    with pytest.raises(UserError, match=told) as refused:
        load(setting)
    assert len(str(refused.value)) < 200


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        (f"{COMPANION}{'__A' * 2000}", "1", f"^environment: {COMPANION}__A__A.*: has 2000 parts"),
        (VARIABLE, "\udcff", f"^environment: {VARIABLE}: is not UTF-8"),
        (VARIABLE, f"0x{'f' * 5000}", r"^environment: descent\.cone\.slope = .* does not fit"),
    ],
)
def test_variable_that_is_none_of_a_configuration_is_one_line(
    name: str, value: str, told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(name, value)
    with pytest.raises(UserError, match=told):
        load()


@pytest.mark.parametrize(
    ("setting", "told"),
    [
        ("slope=0.3", "command line: unknown key 'slope', did you mean descent.cone.slope?"),
        ("descent.cone.slop=0.3", "command line: unknown key 'descent.cone.slop', did you mean 'slope'?"),
        ("descent.cone.slope=steep", 'command line: descent.cone.slope = "steep" does not fit'),
    ],
)
def test_mistake_names_the_command_line_and_the_key_that_was_meant(setting: str, told: str) -> None:
    with pytest.raises(UserError) as refused:
        load(setting)
    assert str(refused.value).startswith(told)


def test_mistake_in_a_variable_names_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, "-1")
    with pytest.raises(UserError, match=r"^environment: descent\.cone\.slope = -1 does not fit"):
        load()


def test_names_that_a_model_leaves_open_keep_their_case() -> None:
    variables = {f"{SIM_AUTOPILOT}__PARAMETERS__MPC_XY_VEL_MAX": "12.0", f"{SIM_AUTOPILOT}__WIND__MEAN_M_S": "4"}
    expected = {"parameters": {"MPC_XY_VEL_MAX": 12.0}, "wind": {"mean_m_s": 4}}
    assert settings_of_environment(SIM_AUTOPILOT, SimAutopilotConfig, variables) == expected


def test_child_that_is_told_everything_inherits_no_setting() -> None:
    assert without_settings({"PATH": "/bin", VARIABLE: "1", "DECKLANDER_SCENARIO__SEED": "2"}) == {"PATH": "/bin"}
