"""`hexapods doctor`, as a user runs it: passed checks, and failed checks with their remedy."""

import socket
import sys
from importlib.metadata import Distribution
from pathlib import Path

import pytest

from app.cli import machine_checks
from app.storage.database.opening import DATABASE_FILE
from app.storage.server_lock import lock_folder, write_address_file
from hexapods.domain.robot import document_of, robot
from tests.cli.examining import ANY_PORT, examined, failures, known_machine
from tests.cli.running import hexapods, in_process, output
from tests.features.needing import needs
from tests.postgresql import PostgresServer
from tests.storage.stores import database_url, opened

__all__ = ["known_machine"]


def test_all_checks_pass_and_no_file_is_created(tmp_path: Path) -> None:
    done = hexapods("doctor", "--data", "data", folder=tmp_path, **ANY_PORT)
    assert done.returncode == 0, done.stdout
    lines = done.stdout.splitlines()
    assert all(line.startswith("✓ ") for line in lines)
    names = [line[2:].partition(":")[0] for line in lines]
    assert names == ["packages", "physics", "machine", "data", "address"]
    assert list(tmp_path.iterdir()) == []


@pytest.mark.promises
def test_an_engine_that_another_package_has_written_over_is_told(tmp_path: Path) -> None:
    (tmp_path / "sitecustomize.py").write_text("import mujoco\nmujoco.__version__ = '3.17.0'\n")
    done = hexapods("doctor", folder=tmp_path, PYTHONPATH=str(tmp_path), **ANY_PORT)
    assert done.returncode == 1
    [failure] = [line for line in done.stdout.splitlines() if line.startswith("✗ ")]
    assert failure.startswith("✗ physics: ")
    assert "the MuJoCo that is loaded is 4.0.0 with the bindings of 3.17" in failure
    assert "install the right one alone: pip uninstall mujoco mujoco-core && " in failure


def test_a_changed_file_of_a_package_is_named(tmp_path: Path) -> None:
    about, module = tmp_path / "engine-1.0.dist-info", tmp_path / "engine" / "__init__.py"
    about.mkdir()
    module.parent.mkdir()
    module.write_text("")
    digest = "47DEQpj8HBSa-_TImW-5JCeuQeRkm5NMpJWZG3hSuFU"
    (about / "METADATA").write_text("Name: engine\nVersion: 1.0\n")
    (about / "RECORD").write_text(f"engine/__init__.py,sha256={digest},0\n")
    package = Distribution.at(about)
    assert machine_checks.changed_file(package) is None
    module.write_text("version = 2\n")
    assert machine_checks.changed_file(package) == "engine/__init__.py"
    module.unlink()
    assert machine_checks.changed_file(package) == "engine/__init__.py"


def test_optional_packages_that_are_missing_are_named_with_what_installs_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert "pip install" not in examined(tmp_path)["packages"][1]
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    passes, said = examined(tmp_path)["packages"]
    assert passes, "all of them are optional"
    assert said.endswith('; without parquet: pip install "racing-hexapods[parquet]"')


def test_quota_and_database_are_checked(tmp_path: Path) -> None:
    with opened(tmp_path / "data", None):
        assert failures(examined(tmp_path)) == {}
    (tmp_path / "data" / "big").write_bytes(bytes(9_500_000))
    checks = examined(tmp_path, HEXAPODS_QUOTA_MB="10")
    assert "raise HEXAPODS_QUOTA_MB" in failures(checks)["machine"]
    (tmp_path / "data" / DATABASE_FILE).write_text("milk" * 1000)
    assert "damaged" in failures(examined(tmp_path))["data"]


@needs("robots")
def test_stored_robots_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    (tmp_path / "rex.json").write_bytes(document_of(robot({"preset": "dog", "femur_m": 0.096})))
    where = ("--name", "Rex", "--data", str(tmp_path / "data"))
    imported = output("robots", "import", "rex.json", *where, folder=tmp_path, run=in_process)
    assert failures(examined(tmp_path)) == {}
    (document,) = (tmp_path / "data" / "robots").rglob(f"{imported['id']}*")
    document.write_bytes(document.read_bytes()[:-9])
    said = failures(examined(tmp_path))["data"]
    assert f"Rex ({imported['id']})" in said
    assert "put a backup" in said


def test_unusable_data_folder_is_named(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("a file")
    assert f"{tmp_path / 'data'} cannot be written" in failures(examined(tmp_path))["data"]


def test_what_other_users_can_open_is_named(tmp_path: Path) -> None:
    with opened(tmp_path / "data", None):
        pass
    (tmp_path / "data").chmod(0o755)
    assert "server.lock" not in failures(examined(tmp_path))["data"]
    (tmp_path / "data" / "server.lock").chmod(0o644)
    named = failures(examined(tmp_path))["data"]
    assert f"{tmp_path / 'data'}, {tmp_path / 'data' / 'server.lock'}, and stop" in named
    assert "chmod go-rwx" in named


def test_port_of_another_process_fails_and_that_of_the_own_server_passes(tmp_path: Path) -> None:
    folder = tmp_path / "data"
    folder.mkdir(mode=0o700)
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        failed = failures(examined(tmp_path, HEXAPODS_PORT=str(port)))
        assert "something else listens" in failed["address"]
        write_address_file(folder, f"http://127.0.0.1:{port}/")
        assert "address" in failures(examined(tmp_path, HEXAPODS_PORT=str(port)))
        with lock_folder(folder):
            assert failures(examined(tmp_path, HEXAPODS_PORT=str(port))) == {}


@pytest.mark.parametrize(
    ("variables", "check", "names"),
    [
        ({"HEXAPODS_HOST": "0.0.0.0"}, "settings", "set HEXAPODS_TOKEN"),
        ({"HEXAPODS_PORT": "many"}, "settings", "from 0 to 65535"),
        ({"HEXAPODS_PUBLIC_URL": "https://hexapods.example"}, "address", "set HEXAPODS_TOKEN"),
    ],
)
def test_invalid_settings_are_named(
    variables: dict[str, str], check: str, names: str, tmp_path: Path
) -> None:
    assert names in failures(examined(tmp_path, **variables))[check]


def test_postgresql_is_checked_without_showing_its_password(
    postgresql: PostgresServer, tmp_path: Path
) -> None:
    with database_url("postgresql", postgresql) as url:
        assert url is not None
        assert "PostgreSQL, made when" in examined(tmp_path, HEXAPODS_DATABASE_URL=url)["data"][1]
        with opened(tmp_path / "data", url):
            checks = examined(tmp_path, HEXAPODS_DATABASE_URL=url)
        assert failures(checks) == {}
        assert "PostgreSQL, all rows" in checks["data"][1]
    away = "postgresql://me:hunter2secret@127.0.0.1:1/hexapods"
    done = hexapods("doctor", folder=tmp_path, **ANY_PORT, HEXAPODS_DATABASE_URL=away)
    assert done.returncode == 1
    assert "✗ data: the PostgreSQL server does not answer" in done.stdout
    assert "hunter2" not in done.stdout + done.stderr
