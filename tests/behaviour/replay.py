"""Run one command of ``fronts`` in this process, and compare its answer with a recorded one.

Strings, booleans and whole numbers must be the same; keys may be added, none may go. Other numbers
must agree within twice the error stated beside them (both sides carry it), but at most a part in
1e4 of the largest of their array: a stated error that covers a finite chain or an extrapolation
would otherwise hide a wrong factor. Where no error is stated, and where it is that of the model
alone, they must agree to a part in 1e9.
"""

from __future__ import annotations

import contextlib
import io
import json
import re
from collections.abc import Iterator, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

from fronts.cli import main

DATA = Path(__file__).parent / "data"
VERDICTS = DATA / "verdicts.json"
EVIDENCE = DATA / "evidence.json"

Json = Any

PART = 1e-9
"""Relative agreement of numbers for which no error is stated: rounding, amplified."""

LARGEST_PART = 1e-4
"""However large the error is that is stated."""

ROUNDING = 1e-14
"""Absolute agreement of numbers near zero: what they are sums of is of order one."""

IGNORED = {"seconds", "map_seconds", "versions", "version", "created", "date", "machine", "source"}
"""Not behaviour: time, date and place of a run."""

COST = {"steps", "stiff_steps", "mean_active", "runs", "terms", "longest_time", "time"}
"""How far or how long a method had to go, not what it found: compared within a tenth."""

ESTIMATES = {
    "error", "radius", "residual", "trivial", "drift", "period_spread", "truncation",
}  # fmt: skip
"""Estimates of error, and others whose names end in ``_error``: compared within a factor of ten."""

MODEL_ERROR = {"closed-form", "envelope"}
"""Methods of ``breather`` and ``threshold`` whose stated error is the distance to the chain (8)."""

PROSE = {"evidence", "message", "reason", "note", "value", "title"}
"""Sentences: a printed number in them may differ by one in its last place."""

LONGEST = 24
"""Longer arrays are recorded by some of their elements."""

NUMBER = re.compile(r"\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def replay(words: Sequence[str]) -> Json:
    """Run ``fronts`` with ``--json`` and return its exit code with its answer or its refusal."""
    out, complaint = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(complaint):
        code = main([*words, "--json"])
    if out.getvalue():
        return {"exit": code, "answer": shortened(json.loads(out.getvalue()))}
    return {"exit": code, "refusal": json.loads(complaint.getvalue().splitlines()[-1])["error"]}


def recorded() -> dict[str, Json]:
    """Return the recorded argument sets by name: why, command, exit code, answer or refusal."""
    others = (VERDICTS, EVIDENCE)
    files = (path for path in sorted(DATA.glob("*.json")) if path not in others)
    return {
        name: case
        for path in files
        for name, case in json.loads(path.read_text(encoding="utf-8")).items()
    }


def shortened(answer: Json) -> Json:
    """Keep of an answer what is compared.

    Of long arrays their length and a dozen elements; of a judged claim its verdict and value, as
    its text is the report's business; nothing of what a run takes or where it is made.
    """
    if isinstance(answer, dict):
        if {"verdict", "because", "explanation"} <= answer.keys():
            return {name: answer[name] for name in ("key", "verdict", "value")}
        if {"claims", "headlines"} <= answer.keys():
            return {"claims": shortened(answer["claims"]), "changed": answer["changed"]}
        return {name: shortened(one) for name, one in answer.items() if name not in IGNORED}
    if not isinstance(answer, list):
        return answer
    if len(answer) > LONGEST and not any(isinstance(one, (dict, str)) for one in answer):
        some = answer[:: max(len(answer) // 12, 1)]
        return {"length": len(answer), "some": some, "last": answer[-1]}
    return [shortened(one) for one in answer]


def differences(old: Json, new: Json) -> list[str]:
    """Return one line for each place where a new answer departs from the recorded one."""
    if "answer" in old and "refusal" in new:
        return [f"exit {new['exit']}: {new['refusal']['message']}"]
    return list(_compare(old, new, "", None, prose=False))


def _compare(
    old: Json, new: Json, where: str, error: float | None, *, prose: bool
) -> Iterator[str]:
    if isinstance(old, dict) and isinstance(new, dict):
        yield from _compare_objects(old, new, where, error, prose=prose)
    elif isinstance(old, list) and isinstance(new, list):
        yield from _compare_arrays(old, new, where, error, prose=prose)
    elif not _same(old, new, error, _size(old), prose=prose):
        yield f"{where}: {old!r} was recorded, now {new!r}"


def _compare_objects(
    old: dict[str, Json], new: dict[str, Json], where: str, error: float | None, *, prose: bool
) -> Iterator[str]:
    model = old.get("method") in MODEL_ERROR or where.rpartition(".")[2] in MODEL_ERROR
    for name, was in old.items():
        place = f"{where}.{name}"
        if name not in new:
            yield f"{place} is missing"
        elif _is_number(was) and _is_number(new[name]) and (name in COST or _estimates(name)):
            ratio = 1.1 if name in COST else 10.0
            # Rounding is of any size, but not where it is that of many digits.
            asked = name in COST or (name != "residual" and 0 < was < 1e-20)
            room = 0.0 if asked else 1e-12
            if not was / ratio - room <= new[name] <= was * ratio + room:
                yield f"{place}: {was!r} was recorded, now {new[name]!r}, another order"
        else:
            now = _turned(was, new[name]) if name == "phases" else new[name]
            stated = None if model else _stated(old, name, error)
            yield from _compare(was, now, place, stated, prose=prose or name in PROSE)


def _turned(was: Json, now: Json) -> Json:
    """Return phases, in units of pi, in the turn of the recorded ones: 1 is -1."""
    if isinstance(was, list) and isinstance(now, list) and len(was) == len(now):
        return [one + 2 * round((old - one) / 2) for old, one in zip(was, now, strict=True)]
    return now


def _compare_arrays(
    old: list[Json], new: list[Json], where: str, error: float | None, *, prose: bool
) -> Iterator[str]:
    for name in ("key", "quantity", "name"):
        if old and all(isinstance(one, dict) and name in one for one in [*old, *new]):
            was, now = ({one[name]: one for one in many} for many in (old, new))
            yield from _compare(was, now, where, error, prose=prose)
            return
    if len(old) != len(new):
        yield f"{where}: {len(old)} elements were recorded, now {len(new)}"
        return
    size = max(map(_size, old), default=0.0)
    for index, (was, now) in enumerate(zip(old, new, strict=True)):
        place = f"{where}[{index}]"
        if isinstance(was, (dict, list)):
            yield from _compare(was, now, place, error, prose=prose)
        elif not _same(was, now, error, size, prose=prose):
            yield f"{place}: {was!r} was recorded, now {now!r}"


def _stated(one: dict[str, Json], name: str, error: float | None) -> float | None:
    """Return the error stated for a quantity beside it, or around it."""
    for stated in (f"{name}_error", f"{name.removesuffix('s')}_error", "error", "radius"):
        if _is_number(one.get(stated)):
            return float(one[stated])
    return error


def _estimates(name: str) -> bool:
    return name in ESTIMATES or name.endswith("_error")


def _is_number(one: Json) -> bool:
    return isinstance(one, (int, float)) and not isinstance(one, bool)


def _size(one: Json) -> float:
    return abs(float(one)) if _is_number(one) else 0.0


def _same(old: Json, new: Json, error: float | None, size: float, *, prose: bool) -> bool:
    if isinstance(old, float) and _is_number(new):
        room = 0.0 if error is None else min(2 * error, max(LARGEST_PART * size, PART))
        return bool(abs(new - old) <= max(room, PART * size, ROUNDING))
    if isinstance(old, str) and isinstance(new, str) and old != new:
        if error is not None and NUMBER.fullmatch(old.lstrip("-")):
            digits = Decimal(new) - Decimal(old)
            return abs(digits) <= 2 * Decimal(error)
        return prose and same_sentence(old, new)
    return isinstance(old, bool) is isinstance(new, bool) and bool(old == new)


def same_sentence(old: str, new: str) -> bool:
    """Whether two sentences say the same, printed numbers being one apart in the last place.

    Quotation marks do not count: those of argparse differ between versions of Python. Rounding
    errors printed as evidence, below 1e-9, are all the same.
    """
    old, new = old.replace("'", ""), new.replace("'", "")
    if NUMBER.split(old) != NUMBER.split(new):
        return False
    for was, now in zip(NUMBER.findall(old), NUMBER.findall(new), strict=True):
        one, other = Decimal(was), Decimal(now)
        whole = was.isdigit()
        last = Decimal(0 if whole else 1).scaleb(int(one.as_tuple().exponent))
        if abs(one - other) > last and max(one, other) > Decimal("1e-9"):
            return False
    return True
