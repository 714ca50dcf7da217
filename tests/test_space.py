"""A Space on Hugging Face: its files as they are written, where there need be no Docker."""

import os
import re
import subprocess
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from app.features.demo.settings import DemoSettings
from app.settings import read_settings

ROOT = Path(__file__).parent.parent
WRITE = ROOT / "deploy" / "space" / "write.sh"
HOST = "owner-name.hf.space"


@pytest.fixture(scope="module")
def space(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("space")
    subprocess.run(["sh", WRITE, folder], check=True)
    return folder


def environment_of(space: Path) -> dict[str, str]:
    """Return the environment that the image sets."""
    last_stage = (space / "Dockerfile").read_text("utf-8").rpartition("\nFROM ")[2]
    return dict(re.findall(r"(HEXAPODS_\w+)=(\S+)", last_stage))


def started(space: Path, folder: Path, **environment: str) -> dict[str, str]:
    """Start a Space in which `hexapods` prints its environment; return that."""
    program = folder / "hexapods"
    program.write_text("#!/bin/sh\nenv\necho ARGUMENTS=$*\n")
    program.chmod(0o755)
    path = f"{folder}{os.pathsep}{os.environ['PATH']}"
    command = ["sh", str(space / "start-space.sh")]
    environment = {**environment_of(space), "PATH": path, **environment}
    said = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return dict(line.partition("=")[::2] for line in said.stdout.splitlines())


def test_the_head_of_its_readme_is_of_a_docker_space(space: Path) -> None:
    _, head, body = (space / "README.md").read_text("utf-8").split("---\n", 2)
    fields: dict[str, Any] = import_module("yaml").safe_load(head)
    assert fields["sdk"] == "docker"
    assert fields["app_port"] == int(environment_of(space)["HEXAPODS_PORT"])
    assert len(fields["short_description"]) <= 60
    assert body.strip().startswith("# Racing Hexapods")
    # That of the repository has none.
    assert (ROOT / "README.md").read_text("utf-8").startswith("# ")


def test_it_has_all_that_its_image_is_built_of(space: Path) -> None:
    ignored = (space / ".dockerignore").read_text("utf-8")
    for line in re.findall(
        r"^COPY (?!--from)(?:--\S+ )*(.+)$", (space / "Dockerfile").read_text(), re.MULTILINE
    ):
        for source in line.split()[:-1]:
            assert [*space.glob(source)], source
            assert f"!{source}\n" in ignored, source


def test_its_pages_are_framed_by_the_hub_and_its_cookies_kept(space: Path, tmp_path: Path) -> None:
    settings = read_settings(started(space, tmp_path, SPACE_HOST=HOST))
    assert settings.public_url == f"https://{HOST}"
    assert settings.frame_ancestors == ("https://huggingface.co",)
    assert settings.has_https
    assert settings.of(DemoSettings).demo
    # The one folder that a Space's user may write to.
    assert settings.data == Path("/tmp/hexapods")


def test_without_a_secret_nobody_is_operator(space: Path, tmp_path: Path) -> None:
    first, second = (started(space, tmp_path)["HEXAPODS_TOKEN"] for _ in range(2))
    assert first != second
    chosen = started(space, tmp_path, HEXAPODS_TOKEN="a-secret-of-the-owner")
    assert (chosen["HEXAPODS_TOKEN"], chosen["ARGUMENTS"]) == ("a-secret-of-the-owner", "serve")


def test_a_folder_is_needed() -> None:
    refused = subprocess.run(["sh", WRITE], capture_output=True, text=True, check=False)
    assert (refused.returncode, "FOLDER" in refused.stderr) == (2, True)
