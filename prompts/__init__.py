"""Prompt texts and their strict rendering."""

from prompts.load_prompt import PromptError, load_prompt, placeholders, render

__all__ = ["PromptError", "load_prompt", "placeholders", "render"]
