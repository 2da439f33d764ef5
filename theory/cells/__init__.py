"""Single oscillators: rest state, unstable and stable cycle."""
