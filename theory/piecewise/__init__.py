"""The piecewise-linear chain (44) in closed form: roots, Σ, kinetic relation, front."""
