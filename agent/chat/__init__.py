"""Conversation with the robot, independent of any face: `Conversation` is what terminal and web page both hold."""

from agent.chat.conversation import Conversation

__all__ = ["Conversation"]
