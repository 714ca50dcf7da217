"""The wheel, installed into an empty environment, is all that a user needs."""

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
SHORTER = {"steps=500": "steps=20", 'world="ice"': 'world="ice", steps=5'}
"""What the gate changes in the README's example, which walks for ten seconds as it stands."""


def start(*command: str | Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command without what this process was started with, in a folder."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("HEXAPODS_", "PYTHON"))}
    return subprocess.run(
        command, cwd=folder, env=kept, capture_output=True, text=True, check=False
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
    """The scripts of an environment that has the wheel and what is pinned, and nothing else."""
    environment = wheel.parent / "environment"
    run(sys.executable, "-m", "venv", "--without-pip", environment, folder=wheel.parent)
    python = environment / "bin" / "python"
    pinned = ("--require-hashes", "--requirement", LOCK)
    for what in (pinned, ("--no-deps", wheel)):
        # As the Makefile does: pip where uv fails, which reads no configuration of pip's.
        uv = (sys.executable, "-m", "uv", "pip", "install", "--python", python, *what)
        if start(*uv, folder=wheel.parent).returncode != 0:
            pip = (sys.executable, "-m", "pip", "--python", python, "install", *what)
            run(*pip, folder=wheel.parent)
    return environment / "bin"


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
            address = next(found[1] for line in said if (found := re.search(r"is at (\S+)", line)))
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
