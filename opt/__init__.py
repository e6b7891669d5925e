"""The quadratic program, the whole-body controller, tuning."""
