"""The report of a study: its results, tables, figures and page."""

from analysis.report.page import analyse, differences, write_report

__all__ = ["analyse", "differences", "write_report"]
