"""Shapes of objects that nothing was tuned or learnt on (benchmark.md section 6), one file a family."""
