"""The made-up claims are material for tests, not tests."""

collect_ignore_glob = ["example_claims/*"]
