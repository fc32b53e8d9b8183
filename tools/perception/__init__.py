"""From two RGB-D pictures to a `Percept`; knows calibration and reference statistics, never the scene's truth."""

from tools.perception.rgbd_perceiver import RgbdPerceiver

__all__ = ["RgbdPerceiver"]
