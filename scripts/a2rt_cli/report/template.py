"""Fills a page's template; every page and section of a report is filled with the same rules."""

from __future__ import annotations

from pathlib import Path
from typing import Any

_TEMPLATES = Path(__file__).resolve().parent


def fill(name: str, **values: Any) -> str:
    """HTML of the template `name` of this folder; text is escaped, an absent value is an error."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(name).render(**values)
