"""Pages that are read off the toolkit when the site is built, into ``docs/generated``.

The equations with their verdicts, the graph of equations, the commands' help, the claims.
"""

import os
import re
import shutil
from html import escape
from pathlib import Path
from typing import Any

HERE = Path(__file__).parents[1]
OUT = HERE / "generated"
REPORT = HERE.parent / "report"


def write(name: str, text: str) -> None:
    """Write a page, only where it has changed, so that Sphinx reads it again only then."""
    path = OUT / name
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def raw(html: str) -> str:
    """Return HTML as a block of MyST."""
    return f"```{{raw}} html\n{html}\n```\n"


def uses() -> dict[int, tuple[list[str], list[str]]]:
    """Return by equation the functions that compute it and the figures that show it."""
    import tomllib

    found: dict[int, tuple[list[str], list[str]]] = {n: ([], []) for n in range(1, 55)}
    rows = tomllib.loads((HERE / "equations.toml").read_text(encoding="utf-8"))["uses"]
    for row in rows:
        for number in row["equations"]:
            found[number][0].extend(row.get("functions", []))
            found[number][1].extend(row.get("figures", []))
    return found


def equations() -> str:
    """Return the page of the 54 equations."""
    from derivations import catalogue
    from derivations.judgement import equations as every
    from derivations.printing import EquationVerdict

    known = uses()
    steps = {step.number: step for made in catalogue.everything() for step in made.steps}
    strip = " ".join(
        f'<a class="eq {each.verdict.value}" href="#eq-{each.number}">{each.number}</a>'
        for each in every()
    )
    legend = " ".join(f'<span class="eq {each}">{each}</span>' for each in EquationVerdict)
    rows = [_row(each, steps[each.number], *known[each.number]) for each in every()]
    table = f'<table class="equations"><tbody>{"".join(rows)}</tbody></table>'
    return (
        (HERE / "equations_head.md").read_text(encoding="utf-8")
        + raw(f'<p class="strip">{strip}</p><p class="legend">{legend}</p>')
        + "\n## The graph of equations\n\n"
        "An arrow leads from an equation to those that follow from it; a click leads to its row. "
        "The picture was drawn by `fronts derive --graph --out equations.svg`.\n\n"
        + raw(f'<div class="graph">{_linked_graph()}</div>')
        + "\n## The table\n\n"
        + raw(table)
    )


def _row(printed: Any, step: Any, functions: list[str], figures: list[str]) -> str:
    from derivations import catalogue
    from paper_checks.report.inline_math import typeset
    from paper_checks.report.mathml import formula

    shown = f'<div class="formula">{formula(printed.latex, block=True)}</div>'
    if printed.amended_latex:
        amended = formula(printed.amended_latex, block=True)
        shown += f'<p class="read">to be read as</p><div class="formula">{amended}</div>'
    sources = ", ".join(
        f'<a href="#eq-{each.number}">({each.number})</a>'
        if each.number is not None
        else escape(each.name)
        for each in step.sources
    )
    name = catalogue.owner(printed.number)
    verdict = printed.verdict.value
    note = f" {typeset(printed.note)}" if printed.note else ""
    lines = [
        f'<span class="eq {verdict}">{verdict}</span>{note}',
        f'Derivation <a href="steps.html#{name}">{escape(name)}</a>: '
        f"{typeset(step.operation)}" + (f" (from {sources})" if sources else ""),
    ]
    if functions:
        lines.append(
            f"Computed by {', '.join(f'<code>{escape(each)}</code>' for each in functions)}"
        )
    if figures:
        links = (f'<a href="gallery/{figure(n)}">Fig. {n}</a>' for n in figures)
        lines.append(f"Seen in {', '.join(links)}")
    remarks = "".join(f"<p>{line}</p>" for line in lines)
    number = printed.number
    return f'<tr id="eq-{number}"><td>({number})</td><td>{shown}{remarks}</td></tr>'


def figure(number: int) -> str:
    """Return the page of the gallery that shows a figure of the paper."""
    (script,) = (HERE / "gallery").glob(f"fig{number:02d}_*.py")
    return f"{script.stem}.html"


def _linked_graph() -> str:
    from derivations import catalogue
    from derivations.graph import svg

    def linked(found: re.Match[str]) -> str:
        return f'<a href="#eq-{found[2]}">{found[1]}</a>'

    picture = svg(catalogue.everything())
    return re.sub(r"(<g><title>(?:(?!</g>).)*?>\((\d+)\)</text></g>)", linked, picture, flags=re.S)


def steps() -> str:
    """Return the page of the derivations: every step with its operation and its equation."""
    from derivations import catalogue
    from derivations.algebra.rendering import equation_mathml
    from paper_checks.report.inline_math import typeset

    parts = [(HERE / "steps_head.md").read_text(encoding="utf-8")]
    for made, name in zip(
        catalogue.everything(), (*catalogue.NUMBERED, "second-order"), strict=True
    ):
        rows = "".join(
            f"<tr><td>{place}</td><td>{typeset(step.operation)}"
            + (
                f' <a href="equations.html#eq-{step.number}">({step.number})</a>'
                if step.number is not None
                else ""
            )
            + f'</td><td><div class="formula">{equation_mathml(step.result)}</div></td></tr>'
            for place, step in enumerate(made.steps, start=1)
        )
        parts.append(
            f"({name})=\n## {made.title}\n\n"
            + raw(
                f'<table class="equations steps" id="{name}"><thead><tr><th></th><th>operation</th>'
                f"<th>result</th></tr></thead><tbody>{rows}</tbody></table>"
            )
        )
    return "\n".join(parts)


def commands() -> dict[str, str]:
    """Return a page for each command, from its own help."""
    from fronts import bound, cli
    from fronts.catalogue import COMMANDS

    os.environ["COLUMNS"] = "96"
    pages = {}
    for name, command in COMMANDS.items():
        text = [f"# `fronts {name}`\n\n{cli._sentence(command.line)}\n"]
        if command.module or "" in command.calls:
            parser, _, _ = cli._chosen(name, command, [])
            text.append(f"```text\n{parser.format_help().rstrip()}\n```\n")
        else:
            for model in bound.models_of(command):
                parser, _, _ = cli._chosen(name, command, [model])
                text.append(
                    f"## `fronts {name} {model}`\n\n```text\n{parser.format_help().rstrip()}\n```\n"
                )
        pages[name] = "\n".join(text)
    return pages


def commands_index() -> str:
    """Return the list of the commands."""
    from fronts.catalogue import COMMANDS
    from fronts.cli import _overview

    tree = "\n".join(f"commands/{name}" for name in COMMANDS)
    return (
        "# The command line\n\n"
        "Each page is the output of `fronts COMMAND --help`. A number may be a range `low:high:n`, "
        "which gives a curve; `--json` prints one JSON object; `--out` writes a file of the kind "
        "that its name indicates. Invalid input ends with exit code 2 and one sentence.\n\n"
        f"```text\n{_overview()}\n```\n\n```{{toctree}}\n:maxdepth: 1\n\n{tree}\n```\n"
    )


def verdicts() -> str:
    """Return the page of the claims with the verdict on record of each."""
    from collections import Counter

    from paper_checks.discover import find_entries
    from paper_checks.report.inline_math import typeset
    from paper_checks.ruling import Verdict

    entries = [each for each in find_entries() if each.group != "equations"]
    entries.sort(key=lambda each: each.claim.recorded is Verdict.UNTESTABLE)  # these come last
    counts = Counter(each.claim.recorded.value for each in entries)
    summary = ", ".join(f"{verdict} {count}" for verdict, count in counts.most_common())
    rows = "".join(
        f'<tr id="{each.claim.key}"><td>{escape(each.claim.place)}</td>'
        f"<td>{typeset(each.claim.quote)}</td><td>{escape(each.claim.recorded.value)}</td>"
        f"<td><code>fronts check {escape(each.claim.key)}</code></td></tr>"
        for each in entries
    )
    head = "<tr><th>where</th><th>what the paper says</th><th>verdict</th><th>judged by</th></tr>"
    report = (
        "The full report, with evidence, pictures and errata: "
        '<a href="../report/index.html">report/index.html</a>.'
        if (REPORT / "index.html").is_file()
        else "The full report, with evidence, pictures and errata, is made by "
        "<code>make paper</code>, and is part of this site where it was made before "
        "<code>make docs</code>."
    )
    return (
        (HERE / "verdicts_head.md").read_text(encoding="utf-8")
        + raw(f"<p>{report}</p>")
        + f"\nVerdicts on the {len(entries)} claims beside the equations: {summary}.\n\n"
        + raw(f'<table class="equations claims"><thead>{head}</thead><tbody>{rows}</tbody></table>')
    )


def speed() -> str:
    """Return the page of the stored benchmark records: what was promised, and what was measured."""
    import json

    parts = [(HERE / "speed_head.md").read_text(encoding="utf-8")]
    for path in sorted((HERE.parent / "benchmarks" / "results").glob("*.json")):
        record = json.loads(path.read_text(encoding="utf-8"))
        targets = [each for each in record.get("targets", ()) if each["limit"] is not None]
        if not targets:
            continue
        rows = "".join(
            f"| {each['claim']} | {each['relation']} {_measure(each['limit'], 'g', each['unit'])} "
            f"| {_measure(each['measured'], '.3g', each['unit'])} | {each['verdict']} |\n"
            for each in targets
        )
        machine = record["machine"]
        parts.append(
            f"## {path.stem}\n\n`{record['command']}`, {record['date']}, {machine['system']}, "
            f"{machine['processor']}, {machine['cores']} cores.\n\n"
            f"| what | target | measured | |\n|---|---|---|---|\n{rows}"
        )
    return "\n".join(parts)


def _measure(value: float, spec: str, unit: str) -> str:
    """Return a number with its unit: of how many times one is the other, a factor."""
    number = format(value, spec)
    if unit.startswith("times"):
        return f"a factor of {number}{unit.removeprefix('times')}"
    return f"{number} {unit}".rstrip()


def sweeps() -> str:
    """Return the page of sweeps, with what the stored record of their benchmark says."""
    import json

    path = HERE.parent / "benchmarks" / "results" / "sweep.json"
    record = json.loads(path.read_text(encoding="utf-8"))
    cost, machine = record["sweep"], record["machine"]
    rows = (
        ("time for a point of the map", f"{cost['map_us']:.0f} µs of processor time"),
        ("time for a point in a simple loop, nothing stored", f"{cost['loop_us']:.0f} µs"),
        ("overhead of the sweep for a point", f"{cost['own_us']:.0f} µs"),
        ("growth of memory", f"{cost['growth']:.0f} bytes per point"),
        ("rows that differ from those of the loop", f"{cost['different']}"),
    )
    return (
        (HERE / "sweeps_head.md").read_text(encoding="utf-8")
        + f"A map of {cost['points']} points of the averaged chain (43) of 16 sites on "
        f"{cost['workers']} workers, into a file: `{record['command']}`, {record['date']}, "
        f"{machine['system']}, {machine['processor']}, {machine['cores']} cores.\n\n"
        "| | |\n|---|---|\n" + "".join(f"| {what} | {said} |\n" for what, said in rows)
    )


def write_all(app: Any) -> None:
    """Write every page."""
    write("equations.md", equations())
    write("steps.md", steps())
    write("verdicts.md", verdicts())
    write("speed.md", speed())
    write("sweeps.md", sweeps())
    write("commands.md", commands_index())
    for name, text in commands().items():
        write(f"commands/{name}.md", text)


def copy_report(app: Any, error: Exception | None) -> None:
    """Copy the verdict report, where it has been made, into the site."""
    if error is None and (REPORT / "index.html").is_file():
        copied = Path(app.outdir) / "report"
        shutil.copytree(REPORT, copied, dirs_exist_ok=True)
        for page in copied.glob("*.html"):  # the report stands beside the site, its copy inside
            text = page.read_text(encoding="utf-8")
            page.write_text(text.replace("../site/index.html", "../index.html"), encoding="utf-8")


def setup(app: Any) -> dict[str, Any]:
    """Register both."""
    app.connect("builder-inited", write_all)
    app.connect("build-finished", copy_report)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
