"""A sweep on a dask cluster: the table of the serial run, though a worker is killed."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from fronts.cli import main
from theory.parameters import ParameterError
from verification.execution.pool import cluster
from verification.execution.sweep import sweep

FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER))  # inherited by spawned processes
sweep_example = importlib.import_module("sweep_example")


def need_distributed() -> Any:
    """The package; where the project is checked as a whole, that it is missing is a failure."""
    if os.environ.get("FRONTS_NEED_CLUSTER"):
        return importlib.import_module("distributed")
    return pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def local() -> Iterator[Any]:
    with need_distributed().LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as made:
        yield made


def test_a_worker_killed_in_mid_sweep_costs_no_point_and_changes_no_bit(
    local: Any, tmp_path: Path
) -> None:
    killed = tmp_path / "killed"
    task = sweep_example.Killed(str(killed))
    with cluster(local.scheduler_address) as executor:
        found = sweep(task, sweep_example.POINTS, executor=executor)
    assert killed.exists()  # by the kill; the serial run passes by it
    assert list(found.rows()) == list(sweep(task, sweep_example.POINTS, workers=1).rows())


def test_a_map_with_boundaries_on_a_cluster_is_the_local_one_in_every_byte(
    local: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["map", "averaged", "--eta", "0.03:0.13:3", "--c", "0.1:0.6:3", "--n", "16"]
    command += ["--refine", "0.25"]
    found = {}
    for name, where in (
        ("here", ["--workers", "1"]), ("there", ["--scheduler", local.scheduler_address]),
    ):  # fmt: skip
        out = tmp_path / f"{name}.csv"
        assert main([*command, *where, "--out", str(out)]) == 0
        found[name] = [
            [line for line in file.read_text().splitlines() if not line.startswith("# command")]
            for file in (out, tmp_path / f"{name}-boundary.csv")
        ]
        capsys.readouterr()
    assert found["there"] == found["here"]
    assert [len(lines) > 1 for lines in found["here"]] == [True, True]


@pytest.mark.parametrize("address", ["somewhere", "tcp://127.0.0.1:1", ""])
def test_an_address_where_no_scheduler_answers_is_refused(
    address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    need_distributed()
    monkeypatch.setattr("verification.execution.pool.CLUSTER_TIMEOUT", 0.5)
    with pytest.raises(ParameterError, match="scheduler"), cluster(address):
        pass


def test_what_is_no_address_is_refused_with_what_one_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace())
    for address in ("nowhere", "tcp://host", "http://host:8786"):
        with pytest.raises(ParameterError) as refusal, cluster(address):
            pass
        assert (refusal.value.quantity, refusal.value.value) == ("scheduler", address)
        assert refusal.value.allowed.startswith("the address of a dask scheduler")
        assert refusal.value.remedy.startswith("start one with")


def test_a_cluster_without_the_package_names_the_extra(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["map", "averaged", "--scheduler", "tcp://host:8786"]) != 0
    assert "excitation-fronts[cluster]" in capsys.readouterr().err


def test_workers_beside_a_scheduler_are_refused(refused: Any) -> None:
    error = refused("map averaged --workers 2 --scheduler tcp://host:8786")
    assert "--workers" in error["message"]


@pytest.mark.parametrize("there", [0, 1])
def test_one_worker_makes_a_cluster(there: int, monkeypatch: pytest.MonkeyPatch) -> None:
    class Client:
        def __init__(self, address: str, **_: object) -> None:
            assert address == "tcp://host:8786"

        def __enter__(self) -> Any:
            return self

        def __exit__(self, *_: object) -> None: ...

        def wait_for_workers(self, count: int, timeout: float) -> None:
            if there < count:
                raise TimeoutError

        def get_executor(self, *, pure: bool) -> str:
            return "executor" if not pure else "one that answers equal tasks once"

    monkeypatch.setitem(sys.modules, "distributed", SimpleNamespace(Client=Client))
    if not there:
        with pytest.raises(ParameterError, match="at least one worker"):
            cluster("tcp://host:8786").__enter__()
        return
    with cluster("tcp://host:8786") as executor:
        assert executor == "executor"  # type: ignore[comparison-overlap]
