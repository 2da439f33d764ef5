"""Model I, Eqs. (1)-(7): the friction chain, its scales, and when steady sliding is stable."""
