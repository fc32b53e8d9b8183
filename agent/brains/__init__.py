"""Room of the project; see docs/."""
