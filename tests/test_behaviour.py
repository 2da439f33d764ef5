"""Every command answers as it was recorded: the same words, and numbers within their errors.

The data are written by ``python -m tests.behaviour.record``. Who changes an answer on purpose
records that argument set again, and the change is read in the diff of the data.
"""

from __future__ import annotations

import copy
import shlex
from collections.abc import Callable
from typing import Any

import pytest

from fronts import derived
from fronts.answer import Answer
from tests.behaviour.replay import Json, differences, recorded, replay, same_sentence
from tests.behaviour.terminal import contradictions

CASES = recorded()


@pytest.mark.parametrize("name", CASES)
def test_a_command_answers_as_recorded_and_alike_in_the_terminal(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers: list[Answer] = []
    run = derived.run

    def kept(*arguments: Any) -> Answer:
        answers.append(run(*arguments))
        return answers[-1]

    monkeypatch.setattr(derived, "run", kept)
    case = CASES[name]
    answer = replay(shlex.split(case["command"]))
    expected = {key: case[key] for key in ("exit", "answer", "refusal") if key in case}
    lines = differences(expected, answer)
    for each in answers:
        lines += contradictions(each.payload, each.text)
    assert not lines, "\n".join([case["command"], *lines])


def _drop(one: Json) -> None:
    del one["answer"]["branches"][0]["admissible"]


def _other_exit(one: Json) -> None:
    one["exit"] = 1


def _other_velocity(one: Json) -> None:
    one["answer"]["branches"][0]["v"] *= 1 + 1e-8


def _other_word(one: Json) -> None:
    one["answer"]["status"] = "pinned"


def _other_limit(one: Json) -> None:
    one["answer"]["reason"] = one["answer"]["reason"].replace("0.4553", "0.4563")


def _null(one: Json) -> None:
    one["answer"]["c_fold"] = None


def _sloppy(one: Json) -> None:
    one["answer"]["branches"][0]["error"] = 1e-6


def _no_branch(one: Json) -> None:
    one["answer"]["branches"] = []


@pytest.mark.parametrize(
    "change",
    [_drop, _other_exit, _other_velocity, _other_word, _other_limit, _null, _sloppy, _no_branch],
)
def test_a_changed_answer_is_noticed(change: Callable[[Json], None]) -> None:
    before = CASES["kinetic-ordinary"]
    after = copy.deepcopy(before)
    assert differences(before, after) == []
    change(after)
    assert len(differences(before, after)) == 1


def test_what_may_change_passes() -> None:
    before = CASES["simulate-vdp"]
    after = copy.deepcopy(before)
    after["answer"]["amplitudes"][5] += after["answer"]["error"]
    after["answer"]["further"] = 1
    after["answer"]["steps"] += 5
    assert differences(before, after) == []
    after["answer"]["amplitudes"][5] += 2 * after["answer"]["error"]
    assert len(differences(before, after)) == 1


def test_sentences_are_compared_with_the_numbers_in_them() -> None:
    assert same_sentence("off by at most 1.4e-14", "off by at most 3.1e-16")
    assert same_sentence("v = 0.3010 at site 14", "v = 0.3011 at site 14")
    assert not same_sentence("v = 0.3010 at site 14", "v = 0.3012 at site 14")
    assert not same_sentence("v = 0.3010 at site 14", "v = 0.3010 at site 15")
    assert not same_sentence("v = 0.3010 at site 14", "c = 0.3010 at site 14")
