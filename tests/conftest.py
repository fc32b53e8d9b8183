"""Settings of all tests: hypothesis draws the same examples every time, so that a run can be repeated.

`HYPOTHESIS_PROFILE=search` draws new ones, to look for what the fixed ones miss.
"""

from __future__ import annotations

import os

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None, print_blob=True)
settings.register_profile("search", deadline=None, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))
