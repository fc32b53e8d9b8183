"""The web page: one server, one token, one live robot, and whoever holds the controls."""
