"""The measurement of a local model: what a device cannot do is a row with its reason, what is our fault is not."""

from __future__ import annotations

from typing import Any

import pytest

from agent.brain import BrainFaultError
from agent.brains.hf_model import HfCfg
from bench import brain_speed
from kb.errors import EnvironmentFaultError


def _row(monkeypatch: pytest.MonkeyPatch, error: Exception) -> brain_speed.BrainSpeed:
    """What comes of a combination whose loading raises."""

    def load(_config: Any) -> Any:
        raise error

    monkeypatch.setattr(brain_speed, "_forget", lambda: None)
    monkeypatch.setattr(brain_speed, "load", load)
    return brain_speed._measured(HfCfg("nowhere", "nf4", "fp8", "cpu"), 1, 1)


@pytest.mark.parametrize("kind", [RuntimeError, NotImplementedError, ImportError, ValueError, BrainFaultError])
def test_what_the_device_cannot_do_is_a_row(monkeypatch: pytest.MonkeyPatch, kind: type[Exception]) -> None:
    """The row names the kind of the error and its words, and has no numbers."""
    row = _row(monkeypatch, kind("no kernel\n for this"))
    assert row.fault == f"{kind.__name__}: no kernel for this"
    assert (row.weights, row.cache, row.tokens_per_s, row.ratio) == ("nf4", "fp8", 0.0, None)


@pytest.mark.parametrize("kind", [TypeError, AttributeError, KeyError, IndexError])
def test_a_fault_of_the_program_is_not_hidden(monkeypatch: pytest.MonkeyPatch, kind: type[Exception]) -> None:
    """Errors that no device raises end the measurement."""
    with pytest.raises(kind):
        _row(monkeypatch, kind("ours"))


def test_a_missing_package_ends_the_measurement(monkeypatch: pytest.MonkeyPatch) -> None:
    """It would be missing for every other combination, too."""
    with pytest.raises(EnvironmentFaultError):
        _row(monkeypatch, EnvironmentFaultError("bitsandbytes is missing", mend="install it"))
