"""From two RGB-D pictures to a `Percept`; knows calibration and reference statistics, never the scene's truth."""
