"""Settings: where they come from, and what is refused before anything starts."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from app.settings import Settings, is_loopback, read_settings, remove_secrets
from hexapods.domain.errors import InvalidInput

TOKEN = "a-token-for-tests"


def test_without_anything_it_is_loopback_and_a_folder_of_the_users() -> None:
    settings = read_settings({})
    assert (settings.host, settings.port, settings.token) == ("127.0.0.1", 8000, None)
    assert settings.data.name == "racing-hexapods"
    assert settings.spectators == "public"


def test_an_option_goes_before_its_variable(tmp_path: Path) -> None:
    environ = {
        "HEXAPODS_HOST": "0.0.0.0",
        "HEXAPODS_PORT": "9000",
        "HEXAPODS_DATA": str(tmp_path),
        "HEXAPODS_TOKEN": TOKEN,
        "HEXAPODS_SPECTATORS": "token",
        "HEXAPODS_PUBLIC_URL": "https://Hexapods.Example/Hex/",
        "HEXAPODS_FRAME_ANCESTORS": "https://Portal.Example, http://localhost:8080",
        "HEXAPODS_ALLOWED_HOSTS": "a.example, B.example,",
        "HEXAPODS_TRUSTED_PROXIES": "127.0.0.1, 10.0.0.0/8, FD00::/8,",
    }
    settings = read_settings(environ, port=0, host=None)
    assert (settings.host, settings.port, settings.data) == ("0.0.0.0", 0, tmp_path)
    assert settings.allowed_hosts == ("a.example", "b.example")
    assert settings.trusted_proxies == ("127.0.0.1", "10.0.0.0/8", "fd00::/8")
    assert settings.proxy_networks == [
        *("127.0.0.1/32", "10.0.0.0/8", "fd00::/8"),
        *("::ffff:127.0.0.1/128", "::ffff:10.0.0.0/104"),
    ]
    assert settings.public_host == "hexapods.example"
    assert settings.public_origin == "https://hexapods.example"
    assert (settings.public_path, settings.has_https) == ("/Hex", True)
    assert settings.frame_ancestors == ("https://portal.example", "http://localhost:8080")


def test_an_empty_variable_is_none() -> None:
    names = [field.name.upper() for field in fields(Settings)]
    assert read_settings({f"HEXAPODS_{name}": "" for name in names}) == read_settings({})


@pytest.mark.parametrize(
    ("environ", "words"),
    [
        ({"HOST": "0.0.0.0"}, ["0.0.0.0", "HEXAPODS_TOKEN", "127.0.0.1"]),
        ({"HOST": "::"}, ["HEXAPODS_TOKEN"]),
        ({"HOST": "192.168.1.5"}, ["HEXAPODS_TOKEN"]),
        ({"HOST": "hexapods.example"}, ["HEXAPODS_TOKEN"]),
        ({"PORT": "99999"}, ["from 0 to 65535"]),
        ({"PORT": "-1"}, ["from 0 to 65535"]),
        ({"PORT": "web"}, ["from 0 to 65535"]),
        ({"TOKEN": "fifteen-letters"}, ["16 to 200"]),
        ({"TOKEN": "has spaces in it, four"}, ["no spaces"]),
        ({"SPECTATORS": "none"}, ["public, token"]),
        ({"LOG_LEVEL": "loud"}, ["LOG_LEVEL", "debug, info"]),
        ({"STARTS_PER_MINUTE": "0"}, ["STARTS_PER_MINUTE", "at least 1"]),
        ({"JOB_NICENESS": "20"}, ["JOB_NICENESS", "from 0 to 19"]),
        ({"STARTS_PER_MINUTE": "many"}, ["STARTS_PER_MINUTE", "whole number"]),
        ({"PUBLIC_URL": "hexapods.example"}, ["https://hexapods.example"]),
        ({"PUBLIC_URL": "https://[x"}, ["https://hexapods.example"]),
        ({"PUBLIC_URL": "https://a.example/hex"}, ["slash", "https://a.example/hex/"]),
        ({"PUBLIC_URL": "https://a.example//hex/"}, ["/user/ada/proxy/8000/", "//hex/"]),
        ({"PUBLIC_URL": "https://a.example/../"}, ["single slashes"]),
        ({"PUBLIC_URL": "https://a.example/h%20x/"}, ["letters, digits"]),
        ({"PUBLIC_URL": "https://a.example/?hex"}, ["https://school.example/hex/"]),
        ({"ALLOWED_HOSTS": "https://a.example"}, ["host names"]),
        ({"FRAME_ANCESTORS": "portal.example"}, ["https://portal.school.example", "none"]),
        ({"FRAME_ANCESTORS": "https://a.example/x"}, ["neither path nor star"]),
        ({"FRAME_ANCESTORS": "https://a.example, *"}, ["origins", "'*'"]),
        ({"FRAME_ANCESTORS": "https://*.example"}, ["neither path nor star"]),
        ({"FRAME_ANCESTORS": "https://a.example;x"}, ["a.example;x"]),
        ({"FRAME_ANCESTORS": "https://a.example:0"}, ["origins"]),
        ({"FRAME_ANCESTORS": "'self'"}, ["origins"]),
        ({"ALLOWED_HOSTS": "*"}, ["host names"]),
        ({"TRUSTED_PROXIES": "*"}, ["TRUSTED_PROXIES", "172.16.0.0/12"]),
        ({"TRUSTED_PROXIES": "127.0.0.1, proxy.example"}, ["proxy.example"]),
        ({"TRUSTED_PROXIES": "10.0.0.1/8"}, ["10.0.0.1/8"]),
        ({"DATABASE_URL": "mysql://me:sesame@host/db"}, ["postgresql://", "SQLite"]),
        ({"DATABASE_URL": "postgresql://me:sesame@host"}, ["postgresql://"]),
        ({"DATABASE_URL": "postgresql://me:sesame@[host/db"}, ["postgresql://"]),
        ({"QUOTA_MB": "9"}, ["at least 10"]),
        ({"QUOTA_MB": "-1"}, ["whole number"]),
        ({"QUOTA_MB": "1 GB"}, ["whole number of megabytes"]),
    ],
    ids=str,
)
def test_invalid_settings_are_refused(environ: dict[str, str], words: list[str]) -> None:
    with pytest.raises(InvalidInput) as error:
        read_settings({f"HEXAPODS_{name}": value for name, value in environ.items()})
    assert all(word in str(error.value) for word in words)
    assert "\n" not in str(error.value)
    assert "sesame" not in str(error.value)


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.9.1", "localhost", "::1"])
def test_loopback_needs_no_token(host: str, tmp_path: Path) -> None:
    assert is_loopback(host)
    Settings(host=host, data=tmp_path)


@pytest.mark.parametrize("where", ["file", "file/below", "proc"])
def test_a_data_folder_that_cannot_be_written(where: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    folder: Any = Path("/proc/hexapods") if where == "proc" else tmp_path / where
    with pytest.raises(InvalidInput, match="HEXAPODS_DATA"):
        Settings(data=folder).prepare_data()


def test_secrets_are_not_shown() -> None:
    url = "postgresql://me:sesame@host/db"
    settings = read_settings({"HEXAPODS_TOKEN": TOKEN, "HEXAPODS_DATABASE_URL": url})
    assert (settings.token, settings.database_url) == (TOKEN, url)
    assert TOKEN not in repr(settings)
    assert "sesame" not in repr(settings)


def test_secrets_can_be_removed_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in (("TOKEN", TOKEN), ("DATABASE_URL", "postgresql://me:sesame@host/db")):
        monkeypatch.setenv(f"HEXAPODS_{name}", value)
    monkeypatch.setenv("HEXAPODS_PORT", "9000")
    remove_secrets()
    settings = read_settings()
    assert (settings.token, settings.database_url, settings.port) == (None, None, 9000)


def test_a_quota_is_in_megabytes() -> None:
    assert read_settings({"HEXAPODS_QUOTA_MB": "500"}).quota_mb == 500
    assert read_settings({}).quota_mb is None
