"""How good retrieval is: systems, queries, three kinds of relevance, measures and a report (`ragvlm kb eval`)."""
