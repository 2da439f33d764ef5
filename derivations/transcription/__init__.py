"""From the printed LaTeX to a SymPy object, and from the two the verdict on print."""
