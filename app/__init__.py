"""The faces of the application: the `ragvlm` command line and the terminal chat. Thin; no reasoning lives here."""
