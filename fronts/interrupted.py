"""Messages of interrupted commands: where the work done so far is, and how to continue it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path


class Interrupted(KeyboardInterrupt):
    """An interruption whose message says what has been saved and how to continue."""


@contextmanager
def resumable(message: Callable[[], str]) -> Iterator[None]:
    """Give interruptions inside the context a message, empty if nothing was saved.

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
    except Interrupted:  # an inner context has given it a message
        raise
    except KeyboardInterrupt:
        raise Interrupted(message()) from None


@contextmanager
def resumable_tables(*outs: Path | None) -> Iterator[None]:
    """Make an interruption of sweeps into these tables name the files that have been saved.

    A SIGTERM between two sweeps counts as an interruption too.
    """
    from verification.execution.interruption import terminated_as_interrupted

    def message() -> str:
        from verification.execution.sweep import part_path

        left = [path for out in outs if out is not None for path in [part_path(out)]]
        names = " and ".join(str(path) for path in left if path.exists())
        return (
            f"{names} is there: the same command with --resume continues from it" if names else ""
        )

    with resumable(message), terminated_as_interrupted():
        yield


def resumable_run(checkpoint: Path | None) -> AbstractContextManager[None]:
    """Make an interruption of a simulation name its checkpoint, if it has been written."""

    def message() -> str:
        if checkpoint is None or not checkpoint.exists():
            return ""
        return f"{checkpoint} is there: the same command with this --checkpoint continues from it"

    return resumable(message)
