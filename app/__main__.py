"""`python -m app` is `ragvlm`."""

from app.command_line import main

main()
