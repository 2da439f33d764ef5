"""
Deriving an equation and checking it
====================================

Every numbered equation of the paper is a model, a definition, an ansatz, or the result of
operations on these. Each step has a check that is independent of the way in which the step was
found.
"""

import fronts as fr

# %%
# An equation
# -----------
# The averaged chain (34) follows from (33) by averaging over the fast phase.

derivation = fr.derivation(34)
(step,) = derivation.steps
print(step.operation)
step.result

# %%
# The check of this step averages (8) numerically at random points and compares the results.

for evidence in derivation.verify():
    print(evidence.holds, "–", evidence.statement)

# %%
# A check that can fail
# ---------------------
# The check can be applied to another equation. If one coefficient is changed, it fails.

wrong = step.result.subs(step.result.lhs, 2 * step.result.lhs + 1)
evidence = step.verify(wrong)
print(evidence.holds, "–", evidence.statement)

# %%
# Where it comes from
# -------------------
# The sources of a step lead back to the model.

chain, source = [], step
while source.sources:
    chain.append(source.label)
    source = source.sources[0]
print(" ← ".join([*chain, source.label]))

# %%
# A whole derivation
# ------------------
# ``fronts derive`` lists the names. Verifying stops at the first check that fails.

friction = fr.derivation("friction")
found = friction.verify()
print(f"{friction.title}: {sum(each.holds for each in found)} of {len(found)} checks hold")

# %%
# An oscillator of your own
# -------------------------
# The same operations average other cells, here one with cubic stiffness. The damping determines the
# cycles, and the stiffness changes the phase at a rate that depends on the amplitude.

mine = fr.derive_cell("1 - a*y**2 + b*y**4", stiffness="g*y**3", values={"a": 4, "b": 0.5})
for cycle in mine.cycles:
    print(f"{cycle.stability} cycle of amplitude {float(cycle.amplitude):.6f}")
print("rate of the phase, per ε and with s = |φ|²:", mine.envelope.shift_mean)
