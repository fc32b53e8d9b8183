"""Run by the tests and killed by them: learns made-up lessons and says each change once it is acknowledged."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from kb.learned import LearnedBase
from tests.learning_fixtures import make_lesson
from tools.learn_experience import Suite, learn_experience

os.environ["RAGVLM_CACHE"] = "memory"
base = LearnedBase.begin(Path(sys.argv[1]), empty=True)
suite = Suite(queries=())
number = int(sys.argv[2])
print("ready", flush=True)
while True:
    number += 1
    # Every third lesson of a kind promotes it, so that most of the time a promotion is being written.
    lesson = make_lesson(f"kind{number // 3}", place=(0.4 + 0.05 * (number % 3), 0.0), seed=number)
    for change in learn_experience([lesson], base, suite):
        print(f"{change.version} {change.kind} {change.says}", flush=True)
