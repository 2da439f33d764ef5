"""Multiple scales for the central particle of the breather, Eqs. (8)-(30)."""
