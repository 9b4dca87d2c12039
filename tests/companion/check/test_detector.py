"""What a check says of the detector of the pad: whether it is there, how late and how good."""

import pytest

from companion.check.detector import DetectorReader, judge_detector
from companion.check.findings import Level
from companion.check.observation import DetectorFacts
from companion.config.companion import CompanionConfig, SilentVehicleConfig
from link.messages import PadSighting
from link.payloads import cdr
from tests.companion.world import configured

SPEED_M_S = 8.0

CONFIG = CompanionConfig()
SILENT = CONFIG.model_copy(update={"silent_vehicle": SilentVehicleConfig()})
ONE_FRAME = configured({"integrity": {"receiver_frames": "one"}}, CONFIG)
START_NS = 1_795_000_000_000_000_000
PERIOD_NS = 40_000_000
LATE_NS = 70_000_000
GOOD = DetectorFacts(is_alive=True, sightings=100, rate_hz=25.0, age_s=0.07, std_m=0.03)


def heard(count: int) -> DetectorReader:
    reader = DetectorReader()
    for index in range(count):
        seen = PadSighting(
            t_ns=START_NS + index * PERIOD_NS,
            position_flu_m=(0.1, 0.0, -3.0),
            orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
            position_covariance_m2=(1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 9e-4),
        )
        reader.sighting(cdr.encode(seen), index * PERIOD_NS, seen.t_ns + LATE_NS)
    return reader


def test_rate_lateness_and_accuracy_are_those_of_its_sightings() -> None:
    facts = heard(26).facts(is_alive=True)
    assert facts.rate_hz == pytest.approx(25.0)
    assert facts.age_s == pytest.approx(0.07)
    assert facts.std_m == pytest.approx(0.03)
    assert {one.level for one in judge_detector(facts, SPEED_M_S, CONFIG)} == {Level.PASS}


def test_bytes_that_are_no_sighting_are_told() -> None:
    reader = DetectorReader()
    reader.sighting(b"\x00\x01\x00\x00no", 0, START_NS)
    (line,) = judge_detector(reader.facts(is_alive=True), SPEED_M_S, CONFIG)
    assert line.level is Level.FAIL
    assert "refused" in line.found


@pytest.mark.parametrize(
    ("facts", "config", "level"),
    [
        (DetectorFacts(), CONFIG, Level.WARN),
        (DetectorFacts(), SILENT, Level.FAIL),
        (DetectorFacts(), ONE_FRAME, Level.PASS),
        (DetectorFacts(is_alive=True), CONFIG, Level.WARN),
    ],
)
def test_a_detector_that_is_not_there_matters_as_far_as_it_is_needed(
    facts: DetectorFacts, config: CompanionConfig, level: Level
) -> None:
    line, *_ = judge_detector(facts, SPEED_M_S, config)
    assert line.level is level


@pytest.mark.parametrize(
    ("changed", "name", "level"),
    [
        ({"rate_hz": 2.0}, "detector", Level.WARN),
        ({"age_s": 0.5}, "detector age", Level.WARN),
        ({"age_s": -0.2}, "detector age", Level.FAIL),
        ({"age_s": None}, "detector age", Level.WARN),
        ({"std_m": 0.4}, "detector accuracy", Level.FAIL),
    ],
)
def test_what_is_late_or_poor_is_named_with_what_to_change(
    changed: dict[str, float | None], name: str, level: Level
) -> None:
    facts = DetectorFacts(**{field: getattr(GOOD, field) for field in GOOD.__slots__} | changed)
    by_name = {one.name: one for one in judge_detector(facts, SPEED_M_S, CONFIG)}
    assert by_name[name].level is level
    assert by_name[name].advice


@pytest.mark.parametrize(("speed_m_s", "level"), [(5.0, Level.PASS), (8.0, Level.WARN)])
def test_stamps_that_put_the_pad_beside_the_drone_are_warned_of_where_nothing_sees_the_pad(
    speed_m_s: float, level: Level
) -> None:
    """Stamps 60 ms off were a contact beside the pad at 15 m/s."""
    _, stamps = judge_detector(DetectorReader().facts(is_alive=False), speed_m_s, CONFIG)
    assert (stamps.name, stamps.level) == ("vehicle stamps", level)
    assert f"{0.05 * speed_m_s:.2f} m" in stamps.found
