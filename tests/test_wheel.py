"""The wheel, installed into an empty environment without extras, serves, trains and races."""

import os
import re
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import httpx2
import pytest

from tests.promises.length import at_length

pytestmark = pytest.mark.promises

CHECKOUT = Path(__file__).parent.parent
LOCK = CHECKOUT / "requirements.lock"
MAX_PACKAGES, MAX_BYTES = 55, 250_000_000
SHORTER = {"steps=500": "steps=20", 'world="ice"': 'world="ice", steps=5'}
"""What the gate changes in the README's example, which walks for ten seconds as it stands."""


def start(*command: str | Path, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a command without what this process was started with, in a folder."""
    inherited = {k: v for k, v in os.environ.items() if not k.startswith(("HEXAPODS_", "PYTHON"))}
    return subprocess.run(
        command, cwd=folder, env=inherited | variables, capture_output=True, text=True, check=False
    )


def run(*command: str | Path, folder: Path) -> str:
    """Run a command that must succeed, and return what it prints."""
    done = start(*command, folder=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    build = (sys.executable, "-m", "hatchling", "build", "--target", "wheel", "-d", folder)
    run(*build, folder=CHECKOUT)
    [built] = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel: Path) -> Path:
    """The scripts of an environment that has the wheel and its dependencies, but no extra."""
    environment = wheel.parent / "environment"
    run(sys.executable, "-m", "venv", "--without-pip", environment, folder=wheel.parent)
    python = environment / "bin" / "python"
    versions = wheel.parent / "versions.txt"
    pins = re.findall(r"^[a-z0-9-]+==[^ ]+", LOCK.read_text(), re.MULTILINE)
    versions.write_text("\n".join(pins))
    into, pinned = ("--python", python), ("--constraint", versions, wheel)
    # As the Makefile does: pip where uv fails, which reads no configuration of pip's.
    uv = (sys.executable, "-m", "uv", "pip", "install", *into, *pinned)
    if start(*uv, folder=wheel.parent).returncode != 0:
        run(sys.executable, "-m", "pip", *into, "install", *pinned, folder=wheel.parent)
    return environment / "bin"


def test_the_wheel_is_small(installed: Path) -> None:
    [packages] = installed.parent.glob("lib/python*/site-packages")
    files = [path for path in packages.rglob("*") if path.suffix != ".pyc" and path.is_file()]
    assert sum(path.stat().st_size for path in files) <= MAX_BYTES
    assert len([*packages.glob("*.dist-info")]) <= MAX_PACKAGES


def test_what_needs_an_extra_says_which_line_installs_it(installed: Path, tmp_path: Path) -> None:
    hexapods = str(installed / "hexapods")
    data = {"HEXAPODS_DATABASE_URL": "postgresql://me@127.0.0.1:1/hexapods"}
    for extra, command, variables in (
        ("cluster", ("experiment", "table1", "--scheduler", "tcp://127.0.0.1:1"), {}),
        ("postgres", ("serve",), data),
    ):
        done = start(hexapods, *command, folder=tmp_path, **variables)
        assert done.returncode == 2, (done.stdout, done.stderr)
        [line] = done.stderr.splitlines()
        # The environment was made without pip.
        assert line.endswith(f'`uv pip install "racing-hexapods[{extra}]"` installs it')


def test_it_trains_and_races(installed: Path, tmp_path: Path) -> None:
    hexapods, gait = str(installed / "hexapods"), ("--gait", "left-right-origin")
    train = ("train", *gait, "--steps", "5", "--out", "q.npz")
    assert "in 50 steps" in run(hexapods, *train, folder=tmp_path)
    race = ("race", *gait, "--steps", "2", "--lane", "greedy", "--lane", "wave")
    assert "greedy" in run(hexapods, *race, folder=tmp_path).lower()


def test_it_carries_the_page_and_the_models_and_no_tests(wheel: Path) -> None:
    packed = set(zipfile.ZipFile(wheel).namelist())
    for folder in ("static", "models"):
        files = [path for path in (CHECKOUT / folder).rglob("*") if path.is_file()]
        expected = {f"hexapods/_{path.relative_to(CHECKOUT).as_posix()}" for path in files}
        assert expected <= packed
    assert "hexapods/exports/servo_maps/freenove.yaml" in packed
    assert {"hexapods/py.typed", "app/py.typed"} <= packed
    packages = {name.split("/")[0] for name in packed if ".dist-info/" not in name}
    assert packages == {"app", "hexapods"}


def test_the_library_is_used_beside_a_package_named_app(installed: Path, tmp_path: Path) -> None:
    (tmp_path / "app.py").write_text("raise ImportError('somebody else’s')")
    readme = (CHECKOUT / "README.md").read_text("utf-8")
    [example] = re.findall(r"```python\n(import hexapods as hx\n.*?)```", readme, re.DOTALL)
    for whole, short in SHORTER.items():
        assert whole in example
        example = example.replace(whole, at_length(short, whole))
    printed = run(installed / "python", "-c", example, folder=tmp_path)
    assert printed.count("Standing(rank=") == 3


def test_it_serves(installed: Path, tmp_path: Path) -> None:
    serve = str(installed / "racing-hexapods")
    command = [serve, "serve", "--port", "0", "--data", str(tmp_path / "data")]
    with subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            said = iter(server.stdout.readline, "")
            address = next(match[1] for line in said if (match := re.search(r"is at (\S+)", line)))
            with httpx2.Client(base_url=address, timeout=60, trust_env=False) as client:
                assert "<title>" in client.get("/").text
                assert client.get("/viewer/").status_code == 200
                body = {"gait": "left-right-origin", "steps": 2, "lanes": [{"agent": "greedy"}]}
                race = client.post("/api/v1/races", json=body).json()
                while race["state"] in ("queued", "running"):
                    time.sleep(0.1)
                    race = client.get(f"/api/v1/races/{race['id']}").json()
                assert race["state"] == "finished", race
        finally:
            server.terminate()
            server.communicate(timeout=60)
