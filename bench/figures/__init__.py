"""The paper's five figures, drawn from real runs of this agent. `make figures` writes them into docs/images."""
