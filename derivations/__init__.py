"""The derivation of each formula, step by step in SymPy. Never imports ``theory``."""
