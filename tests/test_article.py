"""The replication article says what the report says, in the files that ReScience C asks for."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml

from fronts.cli import main
from paper_checks.report.article import FILES

VERDICTS = ("reproduced", "reproduced with a correction", "holds only in part", "not reproduced")


def report() -> dict[str, Any]:
    """A report of four claims, one a verdict; the last two must be told why."""
    claims = [
        {
            "group": "equations" if place < 1 else "fig17",
            "place": f"Fig. {place + 1}",
            "quote": "for $\\hat v ≤ 2$ & 40% of η",
            "verdict": verdict,
            "because": "" if place < 2 else f"reason {place} at v_d.",
            "methods": ["one", "another"][: 1 + (place > 0)],
        }
        for place, verdict in enumerate(VERDICTS)
    ]
    counts = dict.fromkeys(("reproduced", "corrected", "partial", "not-reproduced"), 1)
    return {
        "claims": claims,
        "claims_available": 4,
        "counts": counts | {"untestable": 0, "failed": 0},
        "errata": [
            {"place": "Eq. (2)", "fault": "misprint", "reason": "mu_st must be mu_d."},
            {"place": "Eq. (9)", "fault": "ambiguous", "reason": "two readings."},
        ],
        "versions": {"python": "3.11.7", "numpy": "2.0", "scipy": "1.13"},
        "machine": {},
        "created": "2026-11-22T08:00:00Z",
        "source": "0123456789abcdef",
    }


def written(folder: Path, content: dict[str, Any]) -> int:
    (folder / "report").mkdir()
    (folder / "report" / "report.json").write_text(json.dumps(content), encoding="utf-8")
    return main(
        ["article", "--report", str(folder / "report"), "--out", str(folder / "papers" / "article")]
    )


def test_the_article_has_the_counts_the_reasons_and_the_misprints(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert written(tmp_path, report()) == 0
    text = {name: (tmp_path / "papers" / "article" / name).read_text("utf-8") for name in FILES}
    content = text["content.tex"]
    assert "Of the 4 claims, 1 of them equations,\n3 are judged by two methods" in content
    for shown in ("reason 2 at $v_d$.", "reason 3 at", r"40\% of \ensuremath{\eta}", r"\& 40"):
        assert shown in content
    assert content.index("reason 3") < content.index("reason 2")  # what fails wholly comes first
    assert r"\item[Eq. (2):] " in content
    assert "two readings" not in content
    assert "\n\n\n" not in content
    table = content.partition(r"\begin{tabular}")[2].partition(r"\end{tabular}")[0]
    assert table.count(r"\\" + "\n") == 3
    assert "\n\n" not in table  # a row is a line of the source
    assert "2026-11-22T" not in "".join(text.values())
    assert "2026-11-22" in "".join(text.values())
    folders = [word for name in ("report", "out") for word in (
        f"--{name}", str(tmp_path / {"out": "papers/article"}.get(name, name)))]  # fmt: skip
    capsys.readouterr()
    assert main(["article", *folders, "--json"]) == 0  # in place of the first
    files = json.loads(capsys.readouterr().out)["files"]
    assert files == [str(tmp_path / "papers" / "article" / name) for name in FILES]
    for name in ("content.tex", "article.tex", "bibliography.bib"):
        assert text[name].isascii()
        assert text[name].count("{") == text[name].count("}")


def test_the_metadata_are_those_of_rescience(tmp_path: Path) -> None:
    written(tmp_path, report())
    data = yaml.safe_load((tmp_path / "papers" / "article" / "metadata.yaml").read_text("utf-8"))
    assert {"title", "authors", "affiliations", "keywords", "code", "data", "replication", "review",
            "editor", "reviewers", "dates", "article", "journal", "type", "language", "domain",
            "bibliography", "abstract"} <= set(data)  # fmt: skip
    assert data["type"] == "Replication"
    assert data["authors"][0]["name"]
    assert "Of 4 claims, 1 are reproduced" in data["abstract"]


def test_a_report_of_some_claims_only_and_none_at_all_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert written(tmp_path, report() | {"claims_available": 9}) == 2
    assert "claims of the report = 4" in capsys.readouterr().err
    assert main(["article", "--report", str(tmp_path)]) == 2
    assert "fronts check" in capsys.readouterr().err
    (tmp_path / "report" / "report.json").write_text("{")
    assert main(["article", "--report", str(tmp_path / "report")]) == 2
    assert "is not JSON" in capsys.readouterr().err


@pytest.mark.parametrize(
    "content", [{}, [1], 7, {"claims": [1], "claims_available": 1}, report() | {"counts": {}}]
)
def test_json_that_is_no_report_is_refused_in_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], content: Any
) -> None:
    assert written(tmp_path, content) == 2
    assert "it must be a report.json written by 'fronts check --out'" in capsys.readouterr().err
    assert not (tmp_path / "papers" / "article").exists()


def test_latex_sets_the_article_on_two_pages(tmp_path: Path) -> None:
    """With as many rows as the table takes, each as long as those of the paper's claims."""
    if shutil.which("pdflatex") is None:
        pytest.skip("not installed: pdflatex")
    content = report()
    content["claims"] = [
        each | {"because": 8 * each["because"]} for each in content["claims"] for _ in range(8)
    ]
    content["claims_available"] = len(content["claims"])
    assert written(tmp_path, content) == 0
    done = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "article.tex"],
        cwd=tmp_path / "papers" / "article", capture_output=True, text=True, check=False,
        errors="replace",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout[-2000:]
    assert "(2 pages," in done.stdout
