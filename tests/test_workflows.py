"""Workflows, issue forms and other files of the repository's host: they cannot run here.

They are valid by their schemas, pinned to commits, and name only what is there.
"""

import json
import re
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from tests.other_pythons import CHECKED

ROOT = Path(__file__).parent.parent
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
FORMS = sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml"))
CONFIG = ROOT / ".github" / "ISSUE_TEMPLATE" / "config.yml"
MAKE_TARGETS = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text("utf-8"), re.MULTILINE))

pytestmark = pytest.mark.promises


def loaded(path: Path) -> dict[str, Any]:
    content: dict[str, Any] = import_module("yaml").safe_load(path.read_text("utf-8"))
    return content


@pytest.mark.parametrize(
    ("schema", "files"),
    [
        ("github-workflows", WORKFLOWS),
        ("github-issue-forms", [form for form in FORMS if form != CONFIG]),
        ("github-issue-config", [CONFIG]),
        ("dependabot", [ROOT / ".github" / "dependabot.yml"]),
        ("compose-spec", [ROOT / "compose.yaml"]),
        ("citation-file-format", [ROOT / "CITATION.cff"]),
    ],
)
def test_each_file_is_valid_by_its_schema(schema: str, files: list[Path]) -> None:
    assert files
    check = (sys.executable, "-m", "check_jsonschema", "--builtin-schema", f"vendor.{schema}")
    done = subprocess.run([*check, *files], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


def test_the_audit_of_workflows_finds_no_weakness() -> None:
    audit: list[Path | str] = [
        Path(sys.executable).parent / "zizmor",
        ROOT / ".github",
        "--offline",
        "--no-config",
    ]
    audit += ["--no-progress", "--min-severity", "medium"]
    done = subprocess.run(audit, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_actions_are_pinned_to_commits_with_their_versions(path: Path) -> None:
    for line in re.findall(r"uses: (.*)$", path.read_text("utf-8"), re.MULTILINE):
        if line.startswith("./"):
            assert (ROOT / line).is_file()
        else:
            assert re.fullmatch(r"[\w-]+/[\w-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", line), line


def test_one_action_has_one_version() -> None:
    uses = {
        tuple(line.split("@"))
        for path in WORKFLOWS
        for line in re.findall(r"uses: (\w.*@.*)$", path.read_text("utf-8"), re.MULTILINE)
    }
    assert len(uses) == len({name for name, _ in uses})


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_each_command_is_valid_shell_and_names_targets_that_there_are(path: Path) -> None:
    runs = [
        step["run"]
        for job in loaded(path)["jobs"].values()
        for step in job.get("steps", ())
        if "run" in step
    ]
    for run in runs:
        assert "${{" not in run, "a context is passed by `env`, so that it is never code"
        subprocess.run(["bash", "-n"], input=run, text=True, check=True)
        for target in re.findall(r"^make ([a-z-]+)", run, re.MULTILINE):
            assert target in MAKE_TARGETS, target
        for file in re.findall(r"^(\.ci/\S+)", run, re.MULTILINE):
            assert (ROOT / file).is_file()


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_each_job_ends_and_has_only_the_rights_that_it_names(path: Path) -> None:
    workflow = loaded(path)
    assert workflow["permissions"] == {"contents": "read"}
    for job in workflow["jobs"].values():
        assert "uses" in job or job["timeout-minutes"] <= 90


def test_the_notes_of_a_release_are_its_part_of_the_changelog(tmp_path: Path) -> None:
    steps = loaded(ROOT / ".github/workflows/release.yml")["jobs"]["notes"]["steps"]
    [run] = [step["run"] for step in steps if "gh release" in step.get("run", "")]
    before, _, after = run.partition("gh release")
    assert after
    (tmp_path / "CHANGELOG.md").write_text(
        "## [Unreleased]\n\n- z\n\n## [1.1.0] - 2026-01-02\n\n- b [x]\n\n## [1.0.0] - d\n\n- a\n"
    )
    subprocess.run(
        ["bash", "-e", "-c", before], cwd=tmp_path, env={"GITHUB_REF_NAME": "v1.1.0"}, check=True
    )
    assert (tmp_path / "notes.md").read_text() == "\n- b [x]\n\n"


def test_hooks_of_commits_and_the_development_container_use_what_make_installs() -> None:
    hooks = loaded(ROOT / ".pre-commit-config.yaml")["repos"]
    assert [repository["repo"] for repository in hooks] == ["local"]
    for hook in hooks[0]["hooks"]:
        assert hook["entry"].startswith(".venv/bin/")
    container = json.loads((ROOT / ".devcontainer" / "devcontainer.json").read_text("utf-8"))
    targets = container["postCreateCommand"].removeprefix("make ").split()
    assert set(targets) <= MAKE_TARGETS


def test_the_checks_run_with_each_python_that_the_package_names() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    prefix = "Programming Language :: Python :: 3."
    named = [text for text in project["classifiers"] if text.startswith(prefix)]
    [checks] = [loaded(path) for path in WORKFLOWS if path.name == "checks.yml"]
    pythons = checks["jobs"]["pythons"]["strategy"]["matrix"]["python"]
    assert [f"{prefix}{python.removeprefix('3.')}" for python in pythons] == named
    assert project["requires-python"] == f">={pythons[0]}"
    assert tuple(map(int, pythons[-1].split("."))) == CHECKED
