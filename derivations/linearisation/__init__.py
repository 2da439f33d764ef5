"""Linearisation of the chain, Eqs. (39)-(42): the Jacobian for any N and both kinds of ends."""
