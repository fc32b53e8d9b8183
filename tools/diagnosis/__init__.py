"""Parts of the diagnosis: doubts about success, and the first anomalous event in time."""
