"""What happens once in a run: when, how long, and that it is really flown."""

import numpy as np
import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.channels import channels_of
from scenarios.simulation.drone import sim_autopilot_config
from scenarios.simulation.noise import instant_s, outages_ns
from sim_autopilot.runtime.physics import wind_model

START_NS = 1_800_000_000_000_000_000
DEGRADED = load_scenario("straight_5+link=degraded")
SEEDS = range(400)


def test_outages_have_the_lengths_of_the_benchmark_and_begin_in_the_manoeuvre() -> None:
    first_s, last_s = DEGRADED.run.disturbed_between_s
    for name, channel, shortest_s, longest_s in (
        ("mavlink", DEGRADED.link.mavlink, 2.0, 2.0),
        ("zenoh", DEGRADED.link.zenoh, 1.0, 3.0),
    ):
        spans = [outages_ns(channel, DEGRADED, seed, name, START_NS) for seed in SEEDS]
        assert {len(span) for span in spans} == {1}
        begins_s = np.array([(span[0][0] - START_NS) * 1e-9 for span in spans])
        lengths_s = np.array([(span[0][1] - span[0][0]) * 1e-9 for span in spans])
        assert first_s <= begins_s.min() < first_s + 0.2
        assert last_s - 0.2 < begins_s.max() <= last_s
        # mean of an even distribution; its standard error is 1 / sqrt(12 n) of its width
        assert lengths_s.mean() == pytest.approx(0.5 * (shortest_s + longest_s), abs=0.1)
        assert shortest_s - 1e-9 <= lengths_s.min() <= lengths_s.max() <= longest_s + 1e-9


def test_link_without_outages_has_none() -> None:
    nominal = load_scenario("straight_5+link=nominal")
    assert outages_ns(nominal.link.mavlink, nominal, 1, "mavlink", START_NS) == []


def test_outage_of_mavlink_silences_both_directions_and_nothing_else() -> None:
    channels = channels_of(DEGRADED, 5, START_NS)
    ((begin_ns, end_ns),) = outages_ns(DEGRADED.link.mavlink, DEGRADED, 5, "mavlink", START_NS)
    for link in (channels.down, channels.up):
        for t_ns in range(begin_ns, end_ns, 10_000_000):
            link.put(b"lost", t_ns)
        for index in range(500):
            link.put(b"kept", end_ns + index)
        packets = link.take(end_ns + 1_000_000_000)
        assert set(packets) == {b"kept"}
        assert len(packets) / 500 == pytest.approx(0.8, abs=0.05)  # the benchmark's loss of 20 %


def test_delays_of_the_degraded_links_are_those_of_the_benchmark() -> None:
    channels = channels_of(DEGRADED, 5, START_NS)
    arrivals_ms: list[int] = []
    for _ in range(1000):
        channels.down.put(b"x", START_NS)
    for ms in range(160):
        arrivals_ms += [ms] * len(channels.down.take(START_NS + ms * 1_000_000))
    assert 49 <= min(arrivals_ms) <= 52
    assert 148 <= max(arrivals_ms) <= 151
    channels.zenoh.put("key", b"x", START_NS)
    assert channels.zenoh.take(START_NS + 299_999_999) == []
    assert channels.zenoh.take(START_NS + 300_000_000) == [("key", b"x")]


def test_sightings_come_from_the_drone_itself_unless_their_detector_is_elsewhere() -> None:
    for name, delay_ns in (("degraded", 0), ("degraded_detector", 300_000_000)):
        channels = channels_of(load_scenario(f"straight_5+link={name}"), 5, START_NS)
        channels.detector.put("pad_pose", b"x", START_NS)
        assert channels.detector.take(START_NS + delay_ns - 1) == []
        assert channels.detector.take(START_NS + delay_ns) == [("pad_pose", b"x")]


def test_gust_of_the_preset_is_blown_as_the_standard_has_it() -> None:
    scenario = load_scenario("straight_5+wind=gust")
    calm = scenario.model_copy(update={"wind": scenario.wind.model_copy(update={"gust_m_s": 0.0})})
    with_gust, without = (wind_model(sim_autopilot_config(one, 7, instant=True)) for one in (scenario, calm))
    airspeed_m_s, dt_s = 5.0, 0.01
    blown = np.array([with_gust.advance(dt_s, airspeed_m_s) - without.advance(dt_s, airspeed_m_s) for _ in range(2500)])
    t_s = dt_s * np.arange(1, 2501)
    # MIL-F-8785C 3.7.2.3: V_m / 2 (1 - cos(pi x / d_m)) over the way x through the air, up over d_m and down again
    d_m = 0.5 * airspeed_m_s * scenario.wind.gust_duration_s
    x_m = airspeed_m_s * (t_s - instant_s(scenario, 7, "gust", None))
    inside = (x_m > 0.0) & (x_m < 2.0 * d_m)
    expected_m_s = np.where(inside, 0.5 * 5.0 * (1.0 - np.cos(np.pi * x_m / d_m)), 0.0)
    np.testing.assert_allclose(np.hypot(blown[:, 0], blown[:, 1]), expected_m_s, atol=1e-9)
    np.testing.assert_allclose(blown[:, 2], 0.0, atol=1e-12)
    assert expected_m_s.max() == pytest.approx(5.0, abs=1e-3)


@pytest.mark.parametrize(
    ("preset", "mean_m_s", "turbulence"),
    [
        ("calm", 0.0, "none"),
        ("light", 5.0, "light"),
        ("nominal", 5.0, "moderate"),
        ("moderate", 10.0, "moderate"),
        ("strong", 10.0, "severe"),
    ],
)
def test_wind_of_a_preset_reaches_the_simulated_drone(preset: str, mean_m_s: float, turbulence: str) -> None:
    wind = sim_autopilot_config(load_scenario(f"straight_5+wind={preset}"), 3, instant=True).wind
    assert (wind.mean_m_s, wind.turbulence, wind.gust_m_s) == (mean_m_s, turbulence, 0.0)
