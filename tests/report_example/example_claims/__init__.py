"""Claims about a made-up paper, for the tests of the report. Trouble comes by environment."""
