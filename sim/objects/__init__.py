"""Shapes of the catalogue's objects, one file a family, built of convex pieces."""
