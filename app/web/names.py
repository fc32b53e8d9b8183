"""Names of sessions that the page opens by itself."""

from __future__ import annotations

import datetime
import re
from pathlib import Path


def new_thread(scene: str | None) -> str:
    """A name for a new session: the scene and the moment, as in "cup_near_vase-1122-163012"."""
    stem = re.sub(r"[^A-Za-z0-9_-]", "", Path(scene or "single_cup").stem)[:40] or "scene"
    stem = stem if stem[0].isalnum() else f"s{stem}"
    return f"{stem}-{datetime.datetime.now().strftime('%m%d-%H%M%S-%f')[:-3]}"
