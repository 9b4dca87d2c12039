import io

from scenarios.rare.report import level_line, print_report, report
from scenarios.rare.splitting import Settings
from tests.scenarios.rare.limit_states import linear, split_margin

SETTINGS = Settings(particles=60, moves=4, least=1e-9, seed=1)
MARGIN = linear(0.05)
POPULATION = split_margin(MARGIN, particles=60, seed=1)


def test_report_tells_the_probability_its_interval_and_the_cost() -> None:
    table = report("plane", SETTINGS, POPULATION)
    assert table["converged"] is True
    assert table["probability"]["low"] < 0.05 < table["probability"]["high"]
    assert table["landings"] == 60 + sum(4 * (60 - level["survivors"]) for level in table["levels"])
    out = io.StringIO()
    print_report(table, out)
    assert f"probability of an unsafe landing: {table['probability']['value']:.3g} (95 % interval" in out.getvalue()
    assert f"{table['landings']} landings" in out.getvalue()


def test_worst_landings_are_told_by_what_flies_them_again() -> None:
    worst = report("plane", SETTINGS, POPULATION)["worst"]
    assert worst[0]["margin"] == min(particle.margin for particle in POPULATION.particles)
    particle = min(POPULATION.particles, key=lambda one: one.margin)
    assert worst[0]["seed"] == particle.noise.seed
    assert worst[0]["moves"] == [[move.seed, move.angle_rad] for move in particle.noise.moves]


def test_level_line_tells_how_far_it_is() -> None:
    assert f"level {len(POPULATION.levels)}, margin" in level_line(POPULATION)
