"""The benchmark of sweeps: the map is that of the loop, and its record is what the page says."""

from __future__ import annotations

import importlib
import json
import sys
from pathlib import Path

from benchmarks import sweep as benchmark

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "docs" / "extensions"))
generated_pages = importlib.import_module("generated_pages")


def test_the_map_is_that_of_the_loop() -> None:
    cost = benchmark.measure(60, workers=1)
    assert (cost.points, cost.different) == (60, 0)
    assert min(cost.loop_us, cost.map_us, cost.own_us) > 0.0
    assert f"{cost.points} points on 1 workers" in benchmark.in_words(cost)


def test_the_stored_record_is_of_the_whole_map_without_an_error_and_in_flat_memory() -> None:
    """A row has 8 numbers and words: less than 30 of its bytes each, where it was a kilobyte."""
    cost = json.loads(benchmark.RECORD.read_text(encoding="utf-8"))["sweep"]
    assert (cost["points"], cost["workers"], cost["different"]) == (100_000, 2, 0)
    assert cost["growth"] < 8 * 30
    assert cost["own_us"] < 0.1 * cost["loop_us"]


def test_the_page_of_sweeps_says_what_the_record_says() -> None:
    cost = json.loads(benchmark.RECORD.read_text(encoding="utf-8"))["sweep"]
    page = generated_pages.sweeps()
    for said in (f"{cost['map_us']:.0f} µs", f"{cost['growth']:.0f} bytes per point"):
        assert said in page
