"""compose.yaml, by what it says: where this runs there need be no Docker."""

import re
import tomllib
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from app.setting_fields import PREFIX
from app.settings import read_settings
from tests.setting_defaults import DEFAULTS

FILE = Path(__file__).parent.parent / "compose.yaml"
_PASSWORD = f"{PREFIX}DATABASE_PASSWORD"


@pytest.fixture(scope="module")
def services() -> dict[str, Any]:
    loaded: dict[str, Any] = import_module("yaml").safe_load(FILE.read_text("utf-8"))["services"]
    return loaded


def filled_in(template: str, environment: dict[str, str]) -> str:
    """Return a text with its variables filled in as Compose does it, innermost first."""
    innermost = re.compile(r"\$\{(\w+)(?:(:-|:\+|:\?)([^${}]*))?\}")

    def fill(match: re.Match[str]) -> str:
        value, how, other = environment.get(match[1], ""), match[2], match[3]
        if how == ":+":
            return other if value else ""
        return value or (other if how == ":-" else "")

    while innermost.search(template):
        template = innermost.sub(fill, template)
    return template


def test_every_setting_is_passed_on(services: dict[str, Any]) -> None:
    passed = {name.removeprefix(PREFIX).lower() for name in services["hexapods"]["environment"]}
    # Inside, these are the image's own.
    assert passed == DEFAULTS.keys() - {"host", "port", "data"}


@pytest.mark.parametrize(
    ("environment", "url"),
    [
        ({}, None),
        ({_PASSWORD: "s3cret"}, "postgresql://hexapods:s3cret@postgres/hexapods"),
        ({f"{PREFIX}DATABASE_URL": "postgresql://a@b/c"}, "postgresql://a@b/c"),
        ({f"{PREFIX}DATABASE_URL": "postgresql://a@b/c", _PASSWORD: "x"}, "postgresql://a@b/c"),
    ],
)
def test_the_password_chooses_the_database(
    environment: dict[str, str], url: str | None, services: dict[str, Any]
) -> None:
    template = services["hexapods"]["environment"][f"{PREFIX}DATABASE_URL"]
    settings = read_settings({f"{PREFIX}DATABASE_URL": filled_in(template, environment)})
    assert settings.database_url == url


def test_postgresql_is_a_profile_of_its_own(services: dict[str, Any]) -> None:
    postgres, hexapods = services["postgres"], services["hexapods"]
    assert postgres["profiles"] == ["postgres"]
    assert re.fullmatch(r"postgres:\d+\.\d+-\w+", postgres["image"]), "an exact version"
    assert "ports" not in postgres
    assert postgres["healthcheck"]["test"][1] == "pg_isready"
    assert hexapods["depends_on"]["postgres"] == {"condition": "service_healthy", "required": False}
    assert ":?" in hexapods["environment"][f"{PREFIX}TOKEN"]
    # Required by the image; by Compose it would be of those who use SQLite as well.
    assert postgres["environment"]["POSTGRES_PASSWORD"] == f"${{{_PASSWORD}:-}}"


def test_a_service_takes_no_more_than_its_share(services: dict[str, Any]) -> None:
    for service in services.values():
        assert re.fullmatch(r"\d+g", filled_in(service["mem_limit"], {}))
        assert 100 < service["pids_limit"] < 10_000
    assert services["hexapods"]["ulimits"] == {"nofile": 4096}


def test_what_is_kept_is_kept_in_named_volumes(services: dict[str, Any]) -> None:
    volumes = import_module("yaml").safe_load(FILE.read_text("utf-8"))["volumes"]
    used = {v.partition(":")[0] for service in services.values() for v in service["volumes"]}
    assert used == set(volumes)


def test_the_image_has_all_that_the_wheel_is_made_of() -> None:
    root = FILE.parent
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))
    packed = project["tool"]["hatch"]["build"]["targets"]["wheel"]["only-include"]
    copied = re.findall(r"^COPY ([\w.-]+)", (root / "Dockerfile").read_text("utf-8"), re.MULTILINE)
    sent = re.findall(r"^!([\w.-]+)", (root / ".dockerignore").read_text("utf-8"), re.MULTILINE)
    assert set(packed) <= set(copied)
    assert set(packed) <= set(sent)
