"""Geometry of the 16 scene relations: simple solids from perceived objects, their distances, and one file a relation."""
