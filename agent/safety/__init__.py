"""The gate between a brain and the robot: what a brain other than the rules says counts only after it has passed."""
