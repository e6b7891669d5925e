"""Robots, scenes, sensors, paint and worlds: what is simulated, truth included."""
