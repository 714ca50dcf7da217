"""The seam of features: which there are, what may be left out, and what a folder less means."""

import os
import shutil
import sqlite3
import subprocess
import sys
from collections.abc import Callable
from contextlib import closing
from importlib.util import find_spec
from pathlib import Path

import pytest

from app.installed_features import load
from app.settings import Settings, read_settings
from app.storage.database.opening import DATABASE_FILE
from hexapods.domain.errors import DamagedFile, InvalidInput
from tests.api.conftest import running
from tests.features.needing import needs

ROOT = Path(__file__).parents[1]
IN_ORDER = ("classroom", "tournaments", "demo")
OF_FEATURE = {
    "classroom": "/api/v1/rooms",
    "tournaments": "/api/v1/tournaments",
    "demo": "/api/v1/allowance",
    "explanations": "/api/v1/runs/{run_id}/explain",
    "experiments": "/api/v1/experiments",
    "gait_analysis": "/api/v1/runs/{run_id}/gait",
    "run_code": "/api/v1/runs/{run_id}/code",
    "what_if": "/api/v1/what-if",
    "guide": "/guide/page",
    "archives": "/api/v1/import",
    "exports": "/api/v1/runs/{run_id}/trajectory",
    "robots": "/api/v1/robots/{robot_id}",
    "presenter": "/static/features/presenter/presenter-panel.js",
}
"""An address of each but of those that are a command alone."""
COMMANDS_ALONE = ("mcp",)
NAMES = tuple(
    name for name in (*OF_FEATURE, *COMMANDS_ALONE) if find_spec(f"app.features.{name}") is not None
)
"""Those whose folders are there."""


def names(*without: str) -> tuple[str, ...]:
    return tuple(feature.name for feature in load(without).classes)


@needs("classroom", "tournaments", "demo")
def test_each_comes_after_those_that_it_uses() -> None:
    assert set(NAMES) <= set(names())
    assert [name for name in names() if name in IN_ORDER] == list(IN_ORDER)


def test_each_folder_has_an_address_here_and_a_row_in_the_architecture() -> None:
    folders = {path.parent.name for path in (ROOT / "app/features").glob("*/feature.py")}
    architecture = (ROOT / "docs/architecture.md").read_text("utf-8")

    assert folders - set(NAMES) == set()
    assert [
        name for name in sorted(folders) if f"| `app/features/{name}` |" not in architecture
    ] == []


def test_any_may_be_left_out() -> None:
    for name in NAMES:
        assert set(names(name)) == set(names()) - {name}


def test_an_unknown_name_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(InvalidInput, match=r"HEXAPODS_WITHOUT names no feature by 'clasroom'"):
        load(["clasroom"])
    with pytest.raises(InvalidInput, match=", ".join(sorted(NAMES))):
        load(["clasroom"])


def test_names_are_read_from_the_environment(tmp_path: Path) -> None:
    environ = {"HEXAPODS_DATA": str(tmp_path), "HEXAPODS_WITHOUT": "demo, classroom,"}
    assert read_settings(environ).without == ("demo", "classroom")


def start(data: Path) -> None:
    """Start a server, and stop it."""
    with running(Settings(data=data)):
        pass


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Returns a function that installs a package with features, by the lines of their classes."""

    def install(source: str) -> None:
        (tmp_path / "other_features.py").write_text(
            f"from app.feature import Feature\nfrom starlette.routing import Route\n{source}"
        )
        about = tmp_path / "other_features-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: other_features\nVersion: 1\n")
        lines = [line for line in source.splitlines() if line.startswith("class ")]
        classes = [line.split()[1].partition("(")[0].rstrip(":") for line in lines]
        points = "".join(
            f"{class_name.lower()} = other_features:{class_name}\n" for class_name in classes
        )
        (about / "entry_points.txt").write_text(f"[hexapods.features]\n{points}")
        monkeypatch.syspath_prepend(tmp_path)
        monkeypatch.delitem(sys.modules, "other_features", raising=False)

    return install


@needs("classroom")
def test_what_needs_a_feature_that_is_left_out_is_refused(install: Callable[[str], None]) -> None:
    install('class Exams(Feature):\n    name = "exams"\n    needs = ("classroom",)\n')
    assert names().index("classroom") < names().index("exams")
    assert "exams" not in names("classroom", "exams")
    with pytest.raises(InvalidInput, match=r"exams needs classroom, which is left out; leave"):
        load(["classroom"])


def test_features_that_need_each_other_are_both_loaded(install: Callable[[str], None]) -> None:
    install(
        'class Left(Feature):\n    name = "left"\n    needs = ("right",)\n'
        'class Right(Feature):\n    name = "right"\n    needs = ("left",)\n'
    )
    assert {"left", "right"} <= set(names())


@needs("demo")
def test_two_of_one_name_are_refused(install: Callable[[str], None]) -> None:
    install('class Demo(Feature):\n    name = "demo"\n')
    with pytest.raises(InvalidInput, match=r"two features are called demo.*other_features:Demo"):
        load()


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("class Broken:\n    pass\n", "no subclass of app.feature.Feature"),
        ("class Broken(Missing):\n    pass\n", "cannot be imported"),
    ],
)
def test_a_package_without_a_feature_is_reported(
    install: Callable[[str], None], source: str, message: str
) -> None:
    install(source)
    with pytest.raises(InvalidInput, match=message):
        load()


@pytest.mark.parametrize(
    "without",
    [NAMES, *(pytest.param((name,), marks=pytest.mark.promises) for name in NAMES)],
    ids=["all", *NAMES],
)
def test_a_server_without_features_runs_a_race_and_knows_no_address_of_them(
    without: tuple[str, ...], tmp_path: Path
) -> None:
    with running(Settings(data=tmp_path, job_niceness=0, without=without)) as api:
        described = api.client.get("/openapi.json").json()["paths"]
        for address in (OF_FEATURE[name] for name in without if name in OF_FEATURE):
            assert api.client.get(address).status_code == 404
            assert not [path for path in described if address in path]
        race = {"lanes": [{"agent": "greedy"}, {"agent": "random-walk"}], "steps": 2}
        assert api.finished(api.race(**race))["result"]["lanes"]


@needs("classroom", "tournaments")
def test_what_is_left_out_keeps_its_data(tmp_path: Path) -> None:
    with running(Settings(data=tmp_path)) as api:
        code = api.call("POST", "/rooms", json={}).json()["code"]
    with running(Settings(data=tmp_path, without=("classroom",))) as api:
        assert api.call("GET", f"/rooms/{code}").status_code == 404
        opened = api.call("POST", "/tournaments", json={"rules": {"gait": "tripod"}})
        assert opened.status_code == 201
        refused = api.call("POST", "/tournaments", json={"room": code, "rules": {"gait": "tripod"}})
        assert (refused.status_code, "has no classroom" in refused.text) == (404, True)
    with running(Settings(data=tmp_path)) as api:
        assert api.get(f"/rooms/{code}")["code"] == code


@needs("classroom")
def test_a_missing_table_is_reported(tmp_path: Path) -> None:
    start(tmp_path)
    with closing(sqlite3.connect(tmp_path / DATABASE_FILE)) as file:
        file.execute("DROP TABLE predictions")
    with (
        pytest.raises(DamagedFile, match=r"has lost predictions of the feature classroom; put a"),
        running(Settings(data=tmp_path)),
    ):
        pass
    with running(Settings(data=tmp_path, without=("classroom",))) as api:
        assert api.get("/runs")["items"] == []


@needs("demo")
def test_tables_of_a_newer_version_are_reported(tmp_path: Path) -> None:
    start(tmp_path)
    with closing(sqlite3.connect(tmp_path / DATABASE_FILE)) as file:
        file.execute("UPDATE alembic_version_demo SET version_num = 'demo_9999'")
        file.commit()
    with (
        pytest.raises(InvalidInput, match=r"newer version of the feature demo .*demo_9999"),
        running(Settings(data=tmp_path)),
    ):
        pass


@needs("classroom")
def test_two_features_with_one_page_are_reported(
    tmp_path: Path, install: Callable[[str], None]
) -> None:
    install(
        'class Rival(Feature):\n    name = "rival"\n    def pages(self):\n'
        '        return [Route("/r/{code}", lambda request: None)]\n'
    )
    with (
        pytest.raises(InvalidInput, match=r"rival has the path /r/\{code\}, which is there"),
        running(Settings(data=tmp_path)),
    ):
        pass


def test_two_features_with_one_operation_are_reported(
    tmp_path: Path, install: Callable[[str], None]
) -> None:
    install(
        "from app.api.policy import WATCH, api_router, policy\n"
        "router = api_router()\n"
        '@router.get("/runs/{run_id}")\n'
        "@policy(access=WATCH)\n"
        "def rival(run_id: str) -> None: pass\n"
        'class Rival(Feature):\n    name = "rival"\n    @classmethod\n'
        "    def routers(cls, agents):\n        return (router,)\n"
    )
    with (
        pytest.raises(InvalidInput, match=r"rival has the path GET /api/v1/runs/\{run_id\}, which"),
        running(Settings(data=tmp_path)),
    ):
        pass


_RACE_WITHOUT = """
import sys
from pathlib import Path
from app.settings import Settings
from tests.api.conftest import running

if __name__ == "__main__":
    with running(Settings(data=Path(sys.argv[1]), job_niceness=0)) as api:
        lanes = [{"agent": "greedy"}, {"agent": "random-walk"}]
        print(len(api.finished(api.race(lanes=lanes, steps=2))["result"]["lanes"]))
        print(*(api.client.get(address).status_code for address in ("/", *sys.argv[2:])))
"""


@pytest.mark.promises
@pytest.mark.parametrize("name", NAMES)
def test_the_folder_of_a_feature_can_be_deleted(name: str, tmp_path: Path) -> None:
    """In a copy of the repository."""
    copy = tmp_path / "copy"
    for folder in ("app", "docs", "hexapods", "models", "static", "tests"):
        shutil.copytree(ROOT / folder, copy / folder, ignore=shutil.ignore_patterns("__pycache__"))
    for folder in ("app", "static", "tests"):
        if (copy / folder / "features" / name).is_dir():
            shutil.rmtree(copy / folder / "features" / name)
    (copy / "race_without.py").write_text(_RACE_WITHOUT)
    addresses = [OF_FEATURE[name]] if name in OF_FEATURE else []
    command = [sys.executable, "race_without.py", str(tmp_path / "data"), *addresses]
    environment = {**os.environ, "PYTHONPATH": str(copy)}
    done = subprocess.run(
        command, cwd=copy, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["2", " ".join(["200", *(["404"] * len(addresses))])]
