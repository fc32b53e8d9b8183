"""The conversation in the terminal: a face of `agent.chat.Conversation`."""

from app.chat.converse import chat

__all__ = ["chat"]
