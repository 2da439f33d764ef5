"""What an interrupted command says of its work: where it is, and how to go on."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path


class Interrupted(KeyboardInterrupt):
    """An interruption whose message says what is left of the work and how to go on."""


@contextmanager
def resumable(said: Callable[[], str]) -> Iterator[None]:
    """Let an interruption inside say what is left of the work; an empty text says that nothing is.

    Examples
    --------
    >>> try:
    ...     with resumable(lambda: "run.npz is there"):
    ...         raise KeyboardInterrupt
    ... except Interrupted as interrupted:
    ...     print(interrupted)
    run.npz is there
    """
    try:
        yield
    except Interrupted:  # what was interrupted inside has said it
        raise
    except KeyboardInterrupt:
        raise Interrupted(said()) from None


def resumable_tables(*outs: Path | None) -> AbstractContextManager[None]:
    """Let an interruption of sweeps into these tables name the files that are left."""

    def said() -> str:
        from verification.execution.sweep import part_path

        left = [path for out in outs if out is not None for path in [part_path(out)]]
        names = " and ".join(str(path) for path in left if path.exists())
        return f"{names} is there: the same command with --resume goes on from it" if names else ""

    return resumable(said)


def resumable_run(checkpoint: Path | None) -> AbstractContextManager[None]:
    """Let an interruption of a run name its checkpoint, if it has been written."""

    def said() -> str:
        if checkpoint is None or not checkpoint.exists():
            return ""
        return f"{checkpoint} is there: the same command with this --checkpoint goes on from it"

    return resumable(said)
