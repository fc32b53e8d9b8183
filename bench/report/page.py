"""report.html: one file, no network, light and dark, readable in print."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from bench.report.findings import Card, Finding
from bench.report.table import Table
from bench.report.value import Content, Count, Value, text

WIDE = 12
"""Tables with more columns are set in smaller type, so that all of them are seen at once on an ordinary screen."""
STYLE = Path(__file__).with_name("style.css")


@dataclass(frozen=True)
class Section:
    """A chapter of the page."""

    anchor: str
    title: str
    lead: str
    charts: Sequence[tuple[str, str]]
    """SVG and caption of each chart; empty SVGs are left out."""
    tables: Sequence[Table]


def page(
    title: str, subtitle: str, facts: Mapping[str, str], cards: Sequence[Card], findings: Sequence[Finding],
    sections: Sequence[Section],
) -> str:  # fmt: skip
    """The whole page."""
    shown = [section for section in sections if section.tables or any(svg for svg, _ in section.charts)]
    links = "".join(f'<a href="#{section.anchor}">{escape(section.title)}</a>' for section in shown)
    items = "".join(f"<div><dt>{escape(name)}</dt><dd>{escape(value)}</dd></div>" for name, value in facts.items())
    said = "".join(map(_finding, findings))
    return "".join(
        (
            '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            '<meta name="color-scheme" content="light dark">',
            f"<title>{escape(title)}</title>\n<style>{STYLE.read_text(encoding='utf-8')}</style></head>\n<body>",
            f'<header><h1>{escape(title)}</h1><p class="lead">{escape(subtitle)}</p>',
            f'<dl class="facts">{items}</dl></header>\n<nav>{links}</nav>\n<main>',
            f'<section class="cards">{"".join(map(_card, cards))}</section>\n' if cards else "",
            f'<section class="findings"><h2>What this run shows</h2><ul>{said}</ul></section>\n' if said else "",
            *map(_section, shown),
            "</main></body></html>\n",
        )
    )


def _finding(finding: Finding) -> str:
    kind = finding.mark.replace(" ", "-")
    return (
        f'<li class="{kind}"><span class="mark">{escape(finding.mark)}</span><span>{escape(finding.words)}</span></li>'
    )


def _card(card: Card) -> str:
    return (
        f'<article class="card"><h3>{escape(card.title)}</h3><p class="value">{escape(card.value)}</p>'
        f'<p class="detail">{escape(card.detail)}</p><p class="paper">paper {escape(card.paper)}</p></article>'
    )


def _section(section: Section) -> str:
    charts = "".join(
        f"<figure>{svg}<figcaption>{escape(caption)}</figcaption></figure>" for svg, caption in section.charts if svg
    )
    lead = f'<p class="lead">{escape(section.lead)}</p>' if section.lead else ""
    tables = "".join(map(html_table, section.tables))
    return f'<section id="{section.anchor}"><h2>{escape(section.title)}</h2>{lead}{charts}{tables}</section>\n'


def html_table(table: Table) -> str:
    """A table that scrolls sideways in a narrow window."""
    head = "".join(_head(table, number) for number in range(len(table.columns)))
    body = "".join(_row(table, row) for row in table.rows)
    note = f'<p class="note">{escape(table.note)}</p>' if table.note else ""
    wide = ' class="wide"' if len(table.columns) > WIDE else ""
    return (
        f'<div class="block" id="{escape(table.name)}"><h3>{escape(table.title)}</h3><div class="scroll"><table{wide}>'
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>{note}</div>"
    )


def _head(table: Table, number: int) -> str:
    """The head of a column, above words on the left as they are."""
    words = bool(table.rows) and all(isinstance(row[number], str) for row in table.rows)
    kind = ' class="words"' if words and number else ""
    return f'<th scope="col"{kind}>{_breakable(table.columns[number])}</th>'


def _row(table: Table, row: Sequence[Content]) -> str:
    kind = ' class="strong"' if text(row[0]) in table.emphasis or text(row[0]) == "all" else ""
    cells = "".join(_cell(content, shaded=table.shaded) for content in row[1:])
    return f'<tr{kind}><th scope="row">{escape(text(row[0]))}</th>{cells}</tr>'


def _cell(content: Content, *, shaded: bool) -> str:
    if isinstance(content, Count) and content.share is not None:
        percent = f"{100 * content.share:.1f} %"
        numbers = f"<b>{content.k}</b><i>/{content.n}</i>"
        if shaded:
            return f'<td class="shaded" style="--share:{round(100 * content.share)}%" title="{percent}">{numbers}</td>'
        return f'<td class="count">{numbers} <span>{percent}</span></td>'
    kind = "" if isinstance(content, Value | int) or content is None else ' class="words"'
    return f"<td{kind}>{escape(text(content))}</td>"


def _breakable(name: str) -> str:
    """Long identifiers may break after an underscore."""
    return re.sub("_(?=.)", "_<wbr>", escape(name))
