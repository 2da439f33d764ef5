"""Maps of states over parameters (Figs. 5 and 15): ``state_map``, of any chain.

A ``state`` is determined by rules, in one module for each kind of chain, which fulfil the contract
in ``rules``: ``vdp_rules`` for (8) and (43), ``friction_rules`` for (5), ``smooth_rules`` for any
other smooth chain. ``boundary`` bisects where the state changes.
"""
