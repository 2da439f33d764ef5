"""Pictures of one style, and the numbers behind them: for the claims and the benchmarks."""
