"""The algebra of derivations.

``equations``   equations and systems as live objects, and when two are the same
``operations``  the vocabulary: substitute, solve for, eliminate, divide, select a branch …
``expansion``   time scales, truncation, collecting an order, linearising
``oscillation`` harmonics, secular terms, averages, real and imaginary parts, square and add
``harmonics``   exact polynomials in e^{iT}, for the second order
``steps``       `Given` and `Derived` steps, checks, derivations
``evidence``    checks: values at random points, a predicted order
``rendering``   text, LaTeX, MathML, JSON; ``notation`` names what is shown
``mathml``      LaTeX as MathML

A derivation is a function of its model and reads like an appendix::

    chain = model("chain", m.equation(), "The chain", check=..., number=8)
    centre = derived("centre", (Specialise({n: 0}), ImposeMirrorSymmetry(y)), chain,
                     check=..., number=10)

The first operation receives the results of all sources, each further one the result before it. No
step but a model, a definition or an ansatz is ever given its equation.
"""
