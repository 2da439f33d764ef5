"""Where each formula comes from, step by step in SymPy. Never imports ``theory``."""
