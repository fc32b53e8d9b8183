"""The report of a benchmark run. It reads trials and knows nothing of how they were run."""

from bench.report.write_outputs import write_outputs
from bench.report.write_report import Extras, write_report

__all__ = ["Extras", "write_outputs", "write_report"]
