"""Parts of gathering experience: what is tried with which object, and one physical trial."""
