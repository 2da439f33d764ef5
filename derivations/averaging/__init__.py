"""Averaging of the chain and its decaying solution, Eqs. (31)-(38) and (43), for any cell."""
