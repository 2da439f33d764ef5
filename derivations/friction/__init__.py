"""Model I, Eqs. (1)-(7): the friction chain, its scales, and the stability of steady sliding."""
