"""Networks that refine clouds: AGN, and how it is trained."""
