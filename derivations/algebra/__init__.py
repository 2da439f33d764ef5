"""The algebra of derivations.

``equations``       equations and systems as live objects, and when two are the same
``operations``      what an operation is, and how it describes itself
``substitution``    substitute, eliminate, take a branch, change variables, enter a moving frame
``rearrangement``   join and take, divide, isolate, rewrite, powers, coefficients, derivatives
``solution``        solve for symbols, angles and oscillations; prescribe coefficients
``expansion``       time scales, expansion in a small parameter, limits, linearising
``oscillation``     harmonics, secular terms, averages, real and imaginary parts, square and add
``balance``         the mean power of a harmonic motion
``amplitudes``      modulation equations to second order; ``modulation`` and ``harmonics`` compute
``lattice``         close a chain, write it to first order, insert a plane wave
``dispersion``      the largest group velocity, the envelope of a wave
``transform``       Fourier transform, contours, integrals over a period; ``sums`` over roots
``roots``           count roots; terms at a root; square roots of complex numbers
``steps``           `Given` and `Derived` steps, checks, derivations and how they are written down
``evidence``        checks: values at random points, a predicted order
``rendering``       text, LaTeX, MathML, JSON; ``notation`` names what is shown
``mathml``          LaTeX as MathML

A derivation is a function of its model and reads like an appendix; each step names its sources::

    draft = Draft()
    draft.model("chain", m.equation(), "The chain", check=..., number=8)
    draft.derived("centre", (Substitute({n: 0}), mirrored(y, t, 1)), "chain", check=..., number=10)

The first operation receives the results of all sources, each further one the preceding result. Only
models, definitions and ansätze are given as equations.
"""
