"""The piecewise-linear chain (44) (Figs. 16-18), moved exactly from switching to switching.

``simulation`` measures a front; it moves ``chain`` within ``window`` from one ``crossing`` to the
next; ``verdict`` and ``run`` say what came of it.
"""
