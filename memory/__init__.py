"""Episodic memory M and history H as immutable values with reducers, and the long-term store behind them."""

from memory.episodic import EpisodicMemory, Recollection, merge_memory, recall, remember
from memory.history import HistoryEntry, merge_history, of_goal, tried_types
from memory.item import MemoryItem

__all__ = [
    "EpisodicMemory",
    "HistoryEntry",
    "MemoryItem",
    "Recollection",
    "merge_history",
    "merge_memory",
    "of_goal",
    "recall",
    "remember",
    "tried_types",
]
