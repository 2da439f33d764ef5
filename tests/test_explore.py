"""The explorer in a real browser: loads, follows its sliders, refuses in a sentence, ends."""

import os
import re
import socket
import sys
import time
from importlib.util import find_spec

import matplotlib as mpl
import numpy as np
import pytest

import fronts as fr
from fronts.cli import main
from fronts.explore.calls import Settings, calls, outcome, script
from tests.driven_browser import PROGRAM, TIMEOUT, Browser, explorer

MODEL = "Bokeh.documents[0].get_model_by_name('{}')"

# Bokeh's elements lie in shadow roots, through which selectors of the document do not reach.
EVERY = """(function* every(root) {
  for (const one of root.querySelectorAll('*')) {
    yield one;
    if (one.shadowRoot) yield* every(one.shadowRoot);
  }
})(document)"""
HANDLE = f"[...{EVERY}].find((one) => one.matches('.noUi-handle'))"
TYPED = f"[...{EVERY}].find((one) => one.matches('input.bk-input'))"
BUTTON = f"[...{EVERY}].find((one) => one.matches('button.bk-btn'))"
CODE = f"[...{EVERY}].find((one) => one.matches('pre'))"
SHOWN = f"[...{EVERY}].map((one) => one.matches('.bk-clearfix') ? one.innerText : '').join('\\n')"
PIXELS = f"""[...{EVERY}].filter((one) => one.matches('canvas.bk-layer'))
  .map((one) => one.toDataURL().slice(-4000)).join()"""


@pytest.fixture(scope="module")
def server():
    """Start the explorer from a shell; give what speaks to the shell, and the address."""
    missing = [name for name in ("panel", "bokeh") if find_spec(name) is None]
    missing += [] if PROGRAM else ["a browser"]
    if missing:
        said = f"not installed: {', '.join(missing)}"
        if os.environ.get("FRONTS_NEED_EXPLORER"):
            pytest.fail(said)  # where the project is checked as a whole
        pytest.skip(said)
    outcome(calls(Settings())["run"])  # compiled here, so that the page does not wait for it
    with explorer() as (shell, address):
        yield shell, address


@pytest.fixture(scope="module")
def page(server, tmp_path_factory):
    """Open the page and wait until its last picture is there."""
    with Browser(server[1], tmp_path_factory.mktemp("profile")) as browser:
        curve = MODEL.format("curve-True")
        browser.wait(f"window.Bokeh?.documents.length && {curve}?.data.x.length > 0")
        yield browser


def refusal(call):
    with pytest.raises(fr.ParameterError) as refused:
        call.run()
    return str(refused.value)


def type_coupling(page, text):
    page.ask(f"(() => {{ const box = {TYPED}; box.focus(); box.select(); }})()")
    page.send("Input.insertText", text=text)
    page.press("Enter", 13)


def test_it_shows_what_the_functions_return_and_fetches_nothing_from_elsewhere(page):
    shape = fr.front_profile(c=0.5, eta=0.03125)
    drawn = page.ask(f"[...{MODEL.format('shape')}.data.modulus]")
    # Compiled sums, which a long-lived process uses, round in other places.
    assert drawn == pytest.approx(np.abs(shape.phi), rel=1e-12)
    curve = page.ask(f"{MODEL.format('curve-True')}.data.y.length")
    assert curve == sum(
        bool(each.admissible)
        for point in fr.kinetic_relation(c=[0.025 * n for n in range(1, 81)], eta=0.03125).points
        for each in point.branches
    )
    assert f"v = {shape.v:.6g}" in page.ask(SHOWN)
    elsewhere = [
        each
        for each in page.addresses
        if not re.match(r"(data:|(blob:)?http://127\.0\.0\.1:)", each)
    ]
    assert elsewhere == []


def test_a_slider_moved_by_a_key_changes_numbers_and_pixels(page):
    before = page.ask(PIXELS)
    page.ask(f"{HANDLE}.focus()")
    for _ in range(5):
        page.press("ArrowRight", 39)
    point = MODEL.format("point")
    page.wait(f"Math.abs({point}.data.x[0] - 0.55) < 1e-9")
    found = fr.front_profile(c=0.55, eta=0.03125)
    assert abs(page.ask(f"{point}.data.y[0]") - found.v) <= found.v_error
    page.wait(f"{SHOWN}.includes('v = {fr.front_profile(c=0.55, eta=0.03125).v:.6g}')")
    assert page.ask(PIXELS) != before


def test_the_picture_of_the_chain_runs(page):
    now = MODEL.format("now")
    before = page.ask(f"{now}.location")
    page.wait(f"{now}.location !== {before}")
    at = page.ask(f"[{now}.location, ...{MODEL.format('chain')}.data.y]")
    run = calls(Settings(c=0.55))["run"].run()
    sample = round(at[0] / 80.0 * 120)
    assert np.allclose(at[1:], run.amplitude[sample], rtol=1e-6)  # sent in single precision


def test_a_refused_parameter_shows_its_sentence_in_place_of_the_picture(page):
    type_coupling(page, "-1")
    for name in ("profile", "run"):
        sentence = refusal(calls(Settings(c=-1.0))[name])
        page.wait(f"{SHOWN}.includes({sentence!r}) && !{MODEL.format(name)}.visible")
    type_coupling(page, "0.1")
    page.wait(f"{MODEL.format('run')}.visible")
    assert page.ask(f"{MODEL.format('profile')}.visible") is False  # pinned: no front travels


@pytest.mark.parametrize(
    ("c", "made"),
    [
        ("0.09", {"run", "breather", "curve", "states"}),  # without the profile: pinned
        ("0.6", {"run", "profile", "breather", "curve", "states"}),
    ],
)
def test_the_button_gives_the_python_that_makes_what_the_page_shows(
    c, made, page, tmp_path, monkeypatch
):
    type_coupling(page, c)
    page.wait(
        f"{MODEL.format('profile')}.visible"
        if "profile" in made
        else f"{MODEL.format('multipliers-points')}.data.x.length > 0"
    )
    page.click(BUTTON)
    page.wait(f"{CODE}?.innerText.includes('c={c}')")
    code = page.ask(f"{CODE}.innerText")
    assert set(re.findall(r"^(?:import|from).*", code, re.M)) == {"import fronts as fr"}
    monkeypatch.chdir(tmp_path)
    names = {}
    with mpl.rc_context({"backend": "agg"}):
        exec(compile(code, "shown", "exec"), names)
        mpl.pyplot.close("all")
    assert {path.stem for path in tmp_path.iterdir()} == made
    if "profile" in made:
        drawn = page.ask(f"[...{MODEL.format('shape')}.data.modulus]")
        assert drawn == pytest.approx(np.abs(names["profile"].phi), rel=1e-12)
        assert names["breather"].multipliers is None  # beyond its fold
    else:
        drawn = page.ask(f"[...{MODEL.format('multipliers-points')}.data.x]")
        assert np.array_equal(drawn, names["breather"].multipliers.real)
    curve = [b.v for point in names["curve"].points for b in point.branches if b.admissible]
    assert page.ask(f"[...{MODEL.format('curve-True')}.data.y]") == pytest.approx(curve, rel=1e-12)
    states = names["states"].states
    fronts = np.sort(states["c"][states["label"] == "front"])
    assert np.array_equal(np.sort(page.ask(f"[...{MODEL.format('state-front')}.data.y]")), fronts)
    time, *shown = page.ask(f"[{MODEL.format('now')}.location, ...{MODEL.format('chain')}.data.y]")
    sample = np.abs(names["run"].times * 0.01 - time).argmin()
    assert np.allclose(shown, names["run"].amplitude[sample], rtol=1e-6)


def test_nothing_went_wrong_in_the_page(page):
    assert page.problems == []


def test_it_is_bound_to_this_machine_and_ends_with_the_shell_that_started_it(server, page):
    shell, address = server
    port = int(address.rpartition(":")[2])
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.2", port), timeout=5)
    socket.create_connection(("127.0.0.1", port), timeout=5).close()
    shell.stdin.close()
    last = time.monotonic() + TIMEOUT
    while time.monotonic() < last:
        try:
            socket.create_connection(("127.0.0.1", port), timeout=5).close()
        except ConnectionRefusedError:
            return
        time.sleep(0.1)
    pytest.fail("the server outlives the shell")


def test_without_the_extra_one_sentence_names_it(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "panel", None)
    monkeypatch.delitem(sys.modules, "fronts.explore.page", raising=False)
    assert main(["explore"]) == 2
    assert capsys.readouterr().err == (
        "fronts: the explorer needs panel, which is not installed: "
        "'pip install excitation-fronts[explore]' installs it.\n"
    )


@pytest.mark.parametrize("port", ["-1", "70000", "x"])
def test_a_port_that_is_none_is_refused(port, refused):
    refused(f"explore --port {port}")


@pytest.mark.parametrize(
    "settings", [Settings(eta=0.13), Settings(c=-1.0, model="vdp"), Settings(c=0.01, nucleus=4)]
)
def test_what_is_refused_stands_in_the_program_as_a_comment(settings):
    text = script(settings)
    compile(text, "script", "exec")
    for name in ("chain", "around"):  # what has a name is called by it
        assert (f"\n{name} = " in text) is (f"({name}," in text)
    for name, call in calls(settings).items():
        refused = name != "states" and isinstance(outcome(call), str)
        assert (f"\n# {name}: " in text) is refused
        assert (f"\n{name} = {call}" in text) is not refused
