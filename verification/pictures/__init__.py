"""Pictures in a uniform style, with the numbers behind them, for the claims and the benchmarks."""
