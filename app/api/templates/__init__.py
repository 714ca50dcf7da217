"""HTML pages that the server renders (Jinja templates in this folder)."""

from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, select_autoescape


def render(template: str, folder: Path = Path(__file__).parent, **values: object) -> str:
    """Render a template of this folder, or of another one; values are escaped."""
    return _environment(folder).get_template(template).render(values)


@cache
def _environment(folder: Path) -> Environment:
    return Environment(
        loader=FileSystemLoader(folder),
        autoescape=select_autoescape(),
        trim_blocks=True,
    )
