"""Build the sdist, from it the wheel, install that into a fresh environment, and use it there.

The sdist must hold every file of the checkout, the wheel every file of the packages. In the fresh
environment there is nothing but the wheel and what it declares; the folder is an empty one.
"""

import subprocess
import sys
import tarfile
import tempfile
import venv
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("theory", "derivations", "verification", "paper_checks", "fronts")
USES = (
    ("kinetic", "--c", "0.5", "--eta", "0.03125"),
    ("derive", "--equation", "34"),
    ("front", "averaged", "--a", "4", "--b", "0.5", "--c", "0.6"),
    ("check", "fig16-admissible", "--out", "report"),  # template and style
)


def run(*words: object, where: Path) -> str:
    """Run a program and return what it prints."""
    done = subprocess.run(
        [str(word) for word in words], cwd=where, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def build(into: Path) -> tuple[Path, Path]:
    """Build the sdist and from it the wheel, with what pyproject.toml asks for; return both."""
    run(sys.executable, "-m", "uv", "build", "--quiet", "--out-dir", into, ROOT, where=into)
    (sdist,), (wheel,) = into.glob("*.tar.gz"), into.glob("*.whl")
    return sdist, wheel


def missing(wanted: set[str], found: set[str], where: Path) -> None:
    """Stop if a file is missing."""
    if wanted - found:
        sys.exit(f"{where.name} lacks {', '.join(sorted(wanted - found))}")


def main() -> None:
    """Build, compare, install and use."""
    tracked = set(run("git", "ls-files", where=ROOT).split())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sdist, wheel = build(folder)
        with tarfile.open(sdist) as archive:
            held = {each.name.partition("/")[2] for each in archive.getmembers()}
        missing(tracked, held, sdist)
        with zipfile.ZipFile(wheel) as archive:
            names = set(archive.namelist())
        missing({each for each in tracked if each.split("/")[0] in PACKAGES}, names, wheel)
        fresh = folder / "fresh"
        venv.create(fresh, with_pip=True)
        pip = (
            fresh / "bin" / "python",
            "-m",
            "pip",
            "--disable-pip-version-check",
            "install",
            "-q",
            "--no-compile",
        )
        run(*pip, wheel, where=folder)
        empty = folder / "empty"
        empty.mkdir()
        for words in USES:
            run(fresh / "bin" / "fronts", *words, where=empty)
        print(run(fresh / "bin" / "fronts", "--version", where=empty).strip(), "from", wheel.name)


if __name__ == "__main__":
    main()
