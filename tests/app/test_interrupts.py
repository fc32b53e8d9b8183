"""Ctrl-C stops the robot first and the program second."""

from __future__ import annotations

import os
import signal

import pytest

from app.interrupts import StopOnInterrupt


def test_the_first_press_stops_the_robot_and_the_second_leaves() -> None:
    """One SIGINT presses the stop and returns; another raises KeyboardInterrupt."""
    pressed: list[str] = []
    said: list[str] = []
    with StopOnInterrupt(lambda: pressed.append("stop"), said.append) as guard:
        os.kill(os.getpid(), signal.SIGINT)
        assert guard.pressed
        assert pressed == ["stop"]
        assert len(said) == 1
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
    assert pressed == ["stop"]


def test_the_former_handler_is_put_back() -> None:
    """After the run Ctrl-C means again what it meant before."""
    before = signal.getsignal(signal.SIGINT)
    with StopOnInterrupt(lambda: None):
        assert signal.getsignal(signal.SIGINT) != before
    assert signal.getsignal(signal.SIGINT) == before
