"""One module per model: its parameters, checked on construction, and its equation of motion."""
