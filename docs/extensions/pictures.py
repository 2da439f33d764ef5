"""How the pictures of the site are drawn."""

import matplotlib as mpl


def look(settings: object, script: str) -> None:
    """Set what every script starts from; sphinx-gallery resets Matplotlib between them."""
    mpl.rcParams.update(
        {
            "animation.writer": "pillow",  # without ffmpeg, and without a word about it
            "figure.figsize": (6.4, 4.2),
            "font.size": 10.5,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "legend.frameon": False,
        }
    )
