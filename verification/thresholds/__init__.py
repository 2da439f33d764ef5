"""Couplings at which a nucleus stops being localised (Figs. 4 and 11)."""
