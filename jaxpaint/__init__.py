"""Painting itself: geometry, clouds, mapping, kinematics, decisions. Pure functions on pytrees."""
