"""The verdict on each equation, figure and claim of the paper, and the report that shows them."""
