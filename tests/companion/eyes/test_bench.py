import pytest

from companion.eyes.bench import bench, text_lines


@pytest.mark.slow
def test_the_bench_tells_each_figure_and_tracking_is_the_cheaper() -> None:
    table = bench()
    assert table["tracked_over_searched_speed"] > 1.0
    assert set(table["searched"]) == {"median_ms", "p99_ms", "frames_s"}
    assert "times as fast" in "\n".join(text_lines(table))
