"""One oscillator alone: rest state, unstable and stable cycle."""
