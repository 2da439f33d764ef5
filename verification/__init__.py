"""Whether the theory is true: direct numerical integration, compared with the closed forms."""
