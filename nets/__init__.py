"""Networks that refine clouds. Nothing is exported yet: AGN follows."""
