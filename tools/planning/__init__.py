"""Parts of grasp planning: candidates from geometry, priors from experience, limits from constraints, and their ranking."""
