"""State maps over parameters (Figs. 5 and 15): states, their rules, boundaries."""
