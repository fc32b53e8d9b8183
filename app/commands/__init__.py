"""One file per command of `ragvlm`. Each imports what it needs when it runs, so that `--help` stays fast."""
