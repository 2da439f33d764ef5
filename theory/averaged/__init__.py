"""The averaged Van der Pol chain (34), (43): slow flow, front, closed-form breather (29)-(38)."""
