"""Errors of this package: unsuitable input, and a check that failed."""

from __future__ import annotations


class DerivationInputError(ValueError):
    """An input from which nothing can be derived.

    The message is one sentence: quantity, value, what is allowed, remedy.

    Parameters
    ----------
    quantity : str
        The quantity that was given.
    value : object
        Its value.
    allowed : str
        The allowed values, in words.
    remedy : str
        The remedy.
    """

    def __init__(self, quantity: str, value: object, allowed: str, remedy: str) -> None:
        self.quantity = quantity
        self.value = value
        self.allowed = allowed
        self.remedy = remedy
        super().__init__(f"{quantity} = {value} is not allowed: it must be {allowed}; {remedy}.")


class StepError(DerivationInputError):
    """A step that cannot be carried out for the given model.

    Parameters
    ----------
    step : str
        Name of the step.
    reason : str
        Why it cannot be carried out.
    """

    def __init__(self, step: str, reason: str) -> None:
        remedy = "give a model with fewer springs or lower powers, or numbers for its letters"
        super().__init__("step", step, f"one that can be carried out ({reason})", remedy)
        self.args = (
            f"the step '{step}' cannot be carried out for this model: {reason}; {remedy}.",
        )


class CheckFailedError(ArithmeticError):
    """The check of a step failed; the derivation stops there.

    Parameters
    ----------
    derivation : str
        Key of the derivation.
    position : int
        Position of the step, from 1.
    statement : str
        The statement of the check.
    """

    def __init__(self, derivation: str, position: int, statement: str) -> None:
        self.derivation = derivation
        self.position = position
        self.statement = statement
        super().__init__(f"{derivation}, step {position}: the check failed: {statement}")
