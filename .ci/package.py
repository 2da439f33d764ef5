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


def build(kind: str, source: Path, into: Path) -> Path:
    """Build an sdist or a wheel with the backend itself, and return its file."""
    code = f"import sys; from setuptools.build_meta import *; print(build_{kind}(sys.argv[1]))"
    return into / run(sys.executable, "-c", code, into, where=source).split()[-1]


def missing(wanted: set[str], found: set[str], where: Path) -> None:
    """Stop if a file is missing."""
    if wanted - found:
        sys.exit(f"{where.name} lacks {', '.join(sorted(wanted - found))}")


def main() -> None:
    """Build, compare, install and use."""
    tracked = set(run("git", "ls-files", where=ROOT).split())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sdist = build("sdist", ROOT, folder)
        with tarfile.open(sdist) as archive:
            archive.extractall(folder, filter="data")
            held = {each.name.partition("/")[2] for each in archive.getmembers()}
        missing(tracked, held, sdist)
        source = folder / sdist.name.removesuffix(".tar.gz")
        wheel = build("wheel", source, folder)
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
