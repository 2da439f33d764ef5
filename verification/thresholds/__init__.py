"""Couplings at which a nucleus stops being localised (Figs. 4 and 11): ``threshold``, of any chain.

Its answer is in ``result``. ``continuation`` follows a breather to its fold and watches its
stability. ``spreading`` bisects between runs of any chain. Runs of (43) as the paper prepared them:
``preparation``, with the coupling held in ``escape``, growing slowly in ``slow_sweep``.
"""
