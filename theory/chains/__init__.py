"""One file a model: its parameters, checked on construction, and its equation."""
