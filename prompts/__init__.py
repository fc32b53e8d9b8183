"""Prompt texts and their strict rendering."""

from prompts.load_prompt import PromptError, load_prompt, placeholders, render
from prompts.quote import quoted

__all__ = ["PromptError", "load_prompt", "placeholders", "quoted", "render"]
