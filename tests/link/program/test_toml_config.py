"""Configuration files: what is right comes back the same, what is wrong is named in one line."""

import tomllib
from enum import Enum
from pathlib import Path
from typing import Annotated, Literal, Self

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field, ValidationError, model_validator

from link.errors import UserError
from link.program.toml_config import StrictModel, dump_toml, load_config, merge, validate


class Kind(Enum):
    MPC = "mpc"
    PN = "pn"


class Solver(StrictModel):
    iterations_max: Annotated[int, Field(ge=1, le=500)] = 50
    tolerance: Annotated[float, Field(gt=0.0, le=0.5)] = 1e-4


class Guidance(StrictModel):
    kind: Kind = Kind.MPC
    horizon_s: Annotated[float, Field(gt=0.0, le=10.0)] = 2.0
    offset_m: tuple[float, float, float] = (0.0, -0.5, 1.25)
    solver: Solver = Solver()


class Config(StrictModel):
    name: str = 'a \\ "quoted" name, übrig\n\t\x7f'
    fast: bool = False
    vehicle: str | None = None
    guidance: Guidance = Guidance()
    backup: Guidance | None = None


class Demanding(StrictModel):
    speed_max_m_s: float


def written(folder: Path, text: str) -> Path:
    path = folder / "landing.toml"
    path.write_text(text, encoding="utf-8")
    return path


def complaint(folder: Path, text: str) -> str:
    """Return what is said about a file, without the file's name."""
    path = written(folder, text)
    with pytest.raises(UserError) as caught:
        load_config(path, Config)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert "\n" not in said
    return said.removeprefix(f"{path}: ")


def test_no_file_is_the_defaults() -> None:
    assert load_config(None, Config) == Config()


def test_values_of_the_file_replace_the_defaults(tmp_path: Path) -> None:
    path = written(
        tmp_path, "[guidance]\nkind = 'pn'\nhorizon_s = 3\noffset_m = [1, 2.5, -3]\nsolver.tolerance = 0.1\n"
    )
    config = load_config(path, Config)
    assert config.guidance == Guidance(
        kind=Kind.PN, horizon_s=3.0, offset_m=(1.0, 2.5, -3.0), solver=Solver(tolerance=0.1)
    )
    assert isinstance(config.guidance.horizon_s, float)


def test_overrides_go_before_the_file_and_none_leaves_it(tmp_path: Path) -> None:
    path = written(tmp_path, "name = 'file'\n[guidance]\nhorizon_s = 3.0\n")
    config = load_config(path, Config, {"name": None, "guidance": {"kind": "pn", "horizon_s": 4.0}})
    assert (config.name, config.guidance.kind, config.guidance.horizon_s) == ("file", Kind.PN, 4.0)


def test_merging_leaves_what_it_merges_alone() -> None:
    below, above = {"a": {"x": 1, "y": 2}, "b": 3}, {"a": {"x": 9}, "b": {"z": 4}}
    assert merge(below, above) == {"a": {"x": 9, "y": 2}, "b": {"z": 4}}
    assert below == {"a": {"x": 1, "y": 2}, "b": 3}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("nme = 'x'", "unknown key 'nme', did you mean 'name'?"),
        ("[guidance]\nhorizn_s = 1.0", "unknown key 'guidance.horizn_s', did you mean 'horizon_s'?"),
        ("[guidance.solver]\nzzz = 1", "unknown key 'guidance.solver.zzz'; valid are iterations_max, tolerance"),
        (
            "[guidance]\nhorizon_s = 11.0",
            "guidance.horizon_s = 11.0 does not fit: it must be a number above 0.0 and at most 10.0",
        ),
        (
            "[guidance.solver]\niterations_max = 0",
            "guidance.solver.iterations_max = 0 does not fit: it must be a whole number at least 1 and at most 500",
        ),
        ("[guidance]\nhorizon_s = nan", "guidance.horizon_s = NaN does not fit"),
        ("[guidance.solver]\niterations_max = 2.5", "guidance.solver.iterations_max = 2.5 does not fit"),
        ("fast = 1", "fast = 1 does not fit: it must be a valid boolean"),
        ("[guidance]\nkind = 'pm'", "guidance.kind = \"pm\" does not fit: it must be 'mpc' or 'pn'"),
        ("[guidance]\noffset_m = [1.0, 2.0]", "guidance.offset_m is too short: it must have 3 values or more"),
        (
            "[guidance]\noffset_m = [1.0, 2.0, 3.0, 4.0]",
            "guidance.offset_m is too long: it must have 3 values or fewer",
        ),
        ("guidance = 3", "guidance = 3 does not fit: it is a table, whose keys are set one by one"),
        ("name = ", "not valid TOML"),
    ],
)
def test_a_mistake_is_named_with_its_key_and_what_would_fit(tmp_path: Path, text: str, expected: str) -> None:
    assert complaint(tmp_path, text).startswith(expected)


class Legs(StrictModel):
    speeds_m_s: Annotated[tuple[Annotated[float, Field(ge=0.0)], ...], Field(min_length=2)]

    @model_validator(mode="after")
    def _does_not_stand(self) -> Self:
        if 0.0 in self.speeds_m_s:
            raise ValueError(f"speeds_m_s[{self.speeds_m_s.index(0.0)}] must not be 0")
        return self


class Trip(StrictModel):
    legs: Legs
    name: str = ""


@pytest.mark.parametrize(
    ("wrong", "expected"),
    [
        (-3.5, "legs.speeds_m_s[1234] = -3.5 does not fit: it must be greater than or equal to 0"),
        (0.0, "legs does not fit: speeds_m_s[1234] must not be 0"),
        ("1" * 500, f'legs.speeds_m_s[1234] = "{"1" * 36}... does not fit: it must be a valid number'),
    ],
)
def test_one_bad_number_in_a_long_list_is_told_by_its_place_in_one_short_line(wrong: object, expected: str) -> None:
    speeds_m_s: list[object] = [1.25] * 4000
    speeds_m_s[1234] = wrong
    with pytest.raises(UserError) as caught:
        validate(Trip, {"legs": {"speeds_m_s": speeds_m_s}}, source="x.toml")
    assert str(caught.value) == f"x.toml: {expected}"


@pytest.mark.slow
@given(speeds_m_s=st.lists(st.text(min_size=100), min_size=2), source=st.text("abc/", max_size=300), name=st.integers())
def test_whatever_is_wrong_in_a_file_is_one_line_of_at_most_200_characters_for_each_of_three_mistakes(
    speeds_m_s: list[str], source: str, name: int
) -> None:
    with pytest.raises(UserError) as caught:
        validate(Trip, {"legs": {"speeds_m_s": speeds_m_s}, "name": name}, source=source)
    assert len(str(caught.value).splitlines()) == 1
    assert len(str(caught.value)) <= 3 * 200 + len("; and 9999 more")


class Road(StrictModel):
    kind: Literal["road"]
    length_m: float = 1.0


class Circle(StrictModel):
    kind: Literal["circle"]
    radius_m: Annotated[float, Field(gt=0.0)] = 1.0


class Drive(StrictModel):
    track: Annotated[Road | Circle, Field(discriminator="kind")]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ({"radius": 2.0}, "unknown key 'track.radius', did you mean 'radius_m'?"),
        ({"length_m": 2.0}, "unknown key 'track.length_m'; valid are kind, radius_m"),
        ({"radius_m": -1.0}, "track.radius_m = -1.0 does not fit: it must be a number above 0.0"),
    ],
)
def test_a_mistake_in_a_table_of_some_kind_is_named_as_it_stands_in_the_file(
    values: dict[str, float], expected: str
) -> None:
    with pytest.raises(UserError) as caught:
        validate(Drive, {"track": {"kind": "circle"} | values}, source="x.toml")
    assert str(caught.value) == f"x.toml: {expected}"


@pytest.mark.parametrize(
    ("track", "expected"),
    [
        ({"kind": "spiral"}, "track.kind = \"spiral\" does not fit: it must be one of 'road', 'circle'"),
        ({"radius_m": 2.0}, "key 'track.kind' is missing"),
        (3, "track = 3 does not fit: it is a table, whose keys are set one by one"),
    ],
)
def test_a_table_of_no_kind_is_named_with_the_kinds_there_are(track: object, expected: str) -> None:
    with pytest.raises(UserError) as caught:
        validate(Drive, {"track": track}, source="x.toml")
    assert str(caught.value) == f"x.toml: {expected}"


def test_a_list_that_is_too_short_is_told_how_many_values_it_needs() -> None:
    with pytest.raises(UserError, match=r"^x.toml: legs.speeds_m_s is too short: it must have 2 values or more$"):
        validate(Trip, {"legs": {"speeds_m_s": [1.0]}}, source="x.toml")


def test_a_file_that_holds_no_table_is_told_so() -> None:
    with pytest.raises(UserError, match=r"^x.json: it does not fit: it must be an object$"):
        validate(Config, [], source="x.json")  # type: ignore[arg-type]  # as JSON may hold it


def test_three_mistakes_are_told_and_further_ones_counted(tmp_path: Path) -> None:
    text = "name = 3\nfast = 1\nnme = 2\n[guidance]\nhorizon_s = -1.0"
    told = complaint(tmp_path, text).split("; ")
    assert [one.split(" ")[0] for one in told] == ["unknown", "name", "fast", "and"]
    assert told[-1] == "and 1 more"


def test_a_key_that_another_table_has_is_told_by_its_place(tmp_path: Path) -> None:
    told = complaint(tmp_path, "tolerance = 0.1")
    assert told.startswith("unknown key 'tolerance', did you mean guidance.solver.tolerance or ")


def test_a_misspelt_key_is_named_before_the_key_that_is_missing_for_it() -> None:
    with pytest.raises(UserError, match="unknown key 'speed_m_s', did you mean 'speed_max_m_s'"):
        validate(Demanding, {"speed_m_s": 3.0}, source="x.toml")
    with pytest.raises(UserError, match=r"^x.toml: key 'speed_max_m_s' is missing$"):
        validate(Demanding, {}, source="x.toml")


def test_a_mistake_in_an_override_is_the_command_lines(tmp_path: Path) -> None:
    path = written(tmp_path, "[guidance]\nhorizon_s = 3.0\n")
    with pytest.raises(UserError, match=r"^command line: guidance.horizon_s = 99"):
        load_config(path, Config, {"guidance": {"horizon_s": 99}})
    with pytest.raises(UserError, match=r"landing.toml: guidance.horizon_s = 99"):
        load_config(written(tmp_path, "guidance.horizon_s = 99"), Config, {"guidance": {"kind": "pn"}})


class Span(StrictModel):
    first: int = 1
    last: int = 2

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.last < self.first:
            raise ValueError("last must be at least first")
        return self


@pytest.mark.parametrize(
    ("environment", "overrides", "source"),
    [
        ({}, {}, "a file"),
        ({"first": 5}, {"last": None}, "a file with the environment"),
        ({}, {"first": 5}, "a file with the command line"),
        ({"first": 5}, {"last": 3}, "a file with the environment and the command line"),
    ],
)
def test_values_that_do_not_fit_together_name_all_that_was_laid_over_the_file(
    environment: dict[str, int], overrides: dict[str, int | None], source: str
) -> None:
    with pytest.raises(UserError) as told:
        validate(Span, {"first": 4}, source="a file", environment=environment, overrides=overrides)
    assert str(told.value) == f"{source}: it does not fit: last must be at least first"


def test_files_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"absent.toml: cannot be read \(No such file"):
        load_config(tmp_path / "absent.toml", Config)
    with pytest.raises(UserError, match="cannot be read"):
        load_config(tmp_path, Config)
    (tmp_path / "latin.toml").write_bytes(b"name = '\xe9'")
    with pytest.raises(UserError, match=r"latin.toml: not UTF-8 text"):
        load_config(tmp_path / "latin.toml", Config)


def test_configuration_does_not_change_once_read() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        Solver().tolerance = 0.2


def test_printed_configuration_is_read_back_the_same(tmp_path: Path) -> None:
    config = Config(vehicle="van", fast=True, guidance=Guidance(kind=Kind.PN), backup=Guidance())
    assert load_config(written(tmp_path, dump_toml(config)), Config) == config
    assert load_config(written(tmp_path, dump_toml(Config())), Config) == Config()


@pytest.mark.slow
@given(st.floats(min_value=1e-300, max_value=0.5), st.text(st.characters(codec="utf-8", exclude_characters="\r")))
def test_every_number_and_text_survives_printing(tolerance: float, name: str) -> None:
    config = Config(name=name, guidance=Guidance(solver=Solver(tolerance=tolerance)))
    assert validate(Config, tomllib.loads(dump_toml(config)), source="printed") == config
