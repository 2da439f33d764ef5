"""Conversion of the printed LaTeX to SymPy objects, and its use for the verdict on print."""
