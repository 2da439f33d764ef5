"""Couplings at which a nucleus stops being localised (Figs. 4 and 11): ``threshold``, of any chain.

``result`` defines the results. ``continuation`` follows a breather to its fold and monitors its
stability. ``spreading`` bisects between runs of any chain. Runs of (43) that start as in the paper
are made by ``preparation``, with the coupling held fixed in ``escape`` and growing slowly in
``slow_sweep``.
"""
