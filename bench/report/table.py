"""A table of the report: one value that Markdown, LaTeX, CSV and HTML are written from."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass

from bench.report.value import Content, Value, text

_TEX = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
    "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "±": r"$\pm$", "–": "--", "\N{MINUS SIGN}": "$-$",
    "→": r"$\to$", "≥": r"$\geq$", "≤": r"$\leq$", "<": r"$<$", ">": r"$>$", "Δ": r"$\Delta$", "κ": r"$\kappa$",
    "∧": r"$\wedge$", "·": r"$\cdot$", "×": r"$\times$", "@": "@",
}  # fmt: skip


@dataclass(frozen=True)
class Table:
    """Rows under columns."""

    name: str
    """Short name, unique in a report: anchor, file name, label."""
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Content, ...], ...]
    note: str = ""
    """What a reader must know to read it."""
    emphasis: frozenset[str] = frozenset()
    """First cells of the rows that stand out."""
    shaded: bool = False
    """Cells that are counts are shaded by their share."""

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ValueError(f"table {self.name}: {len(row)} cells under {len(self.columns)} columns: {row}")

    def markdown(self) -> str:
        """GitHub's Markdown."""
        lines = [f"### {self.title}", ""]
        lines += ["| " + " | ".join(_bars(name) for name in self.columns) + " |"]
        lines += ["|" + "|".join("---" if i == 0 else "---:" for i in range(len(self.columns))) + "|"]
        for row in self.rows:
            cells = [_bars(text(item)) for item in row]
            if text(row[0]) in self.emphasis:
                cells = [f"**{item}**" for item in cells]
            lines.append("| " + " | ".join(cells) + " |")
        return "\n".join([*lines, "", *([self.note, ""] if self.note else [])])

    def tex(self) -> str:
        """LaTeX with booktabs."""
        lines = [
            r"\begin{table}[t]",
            r"\centering",
            rf"\caption{{{tex_escape(self.title)}}}",
            rf"\label{{tab:{self.name}}}",
            rf"\begin{{tabular}}{{@{{}}l{'r' * (len(self.columns) - 1)}@{{}}}}",
            r"\toprule",
            " & ".join(rf"\textbf{{{tex_escape(name)}}}" for name in self.columns) + r" \\",
            r"\midrule",
        ]
        for row in self.rows:
            cells = [tex_escape(text(item)) for item in row]
            if text(row[0]) in self.emphasis:
                cells = [rf"\textbf{{{item}}}" for item in cells]
            lines.append(" & ".join(cells) + r" \\")
        lines += [r"\bottomrule", r"\end{tabular}"]
        if self.note:
            lines.append(rf"\par\smallskip\footnotesize {tex_escape(self.note)}")
        return "\n".join([*lines, r"\end{table}", ""])

    def csv(self) -> str:
        """Comma-separated values; a count fills a column for k and one for n."""
        widths = [self._parts(number) for number in range(len(self.columns))]
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(
            [
                " ".join(filter(None, (name, part)))
                for name, parts in zip(self.columns, widths, strict=True)
                for part in parts
            ]
        )
        for row in self.rows:
            writer.writerow(
                [item for content, parts in zip(row, widths, strict=True) for item in _raw(content, len(parts))]
            )
        return out.getvalue()

    def _parts(self, number: int) -> tuple[str, ...]:
        found = [row[number].parts for row in self.rows if isinstance(row[number], Value)]  # type: ignore[union-attr]
        return max(found, key=len) if found else ("",)


def _raw(content: Content, width: int) -> Sequence[object]:
    values: Sequence[object] = content.raw() if isinstance(content, Value) else ("" if content is None else content,)
    return [*values, *[""] * (width - len(values))]


def _bars(cell: str) -> str:
    return cell.replace("|", "\\|").replace("\n", " ")


def tex_escape(words: str) -> str:
    """Words that LaTeX sets as they are read."""
    return re.sub("|".join(map(re.escape, _TEX)), lambda found: _TEX[found.group()], words)
