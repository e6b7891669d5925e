"""The command line, the papers' tables and figures, reports and benchmarks."""
