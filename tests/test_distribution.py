"""The sdist, and the wheel that is built from it: what an index shows of them, what they hold."""

import re
import subprocess
import sys
import tarfile
import zipfile
from email import message_from_bytes, policy
from email.message import EmailMessage
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import pytest
from readme_renderer import markdown

from hexapods import __version__

CHECKOUT = Path(__file__).parent.parent
ADDRESS = "https://forge.racing-hexapods.org/someone/racing-hexapods"
"""Of no repository: the tests need the form alone."""
FILES = f"{ADDRESS}/(blob|raw)/v{re.escape(__version__)}/"


@pytest.fixture(scope="module")
def hook() -> ModuleType:
    """The module that Hatchling loads from the file of this name."""
    spec = spec_from_file_location("hatch_build", CHECKOUT / "hatch_build.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("quote", ["", '"', "'"])
def test_the_address_is_read_from_the_citation(hook: ModuleType, quote: str) -> None:
    citation = f"license: MIT\nrepository-code: {quote}{ADDRESS}{quote}\ntype: software\n"
    assert hook.repository_address(citation) == ADDRESS
    assert hook.repository_address("license: MIT\n") is None


@pytest.mark.parametrize(
    "address",
    [
        "",
        "racing-hexapods",
        "http://forge.org/a/b",
        "https://forge.org",
        "https://forge.org/a/b/",
        "https://example.com/a/b",
        "https://host.example/a/b",
        "https://host.invalid/a/b",
        "https://localhost/a/b",
        "https://OWNER/NAME",
    ],
)
def test_what_is_no_address_is_refused_with_its_form(hook: ModuleType, address: str) -> None:
    with pytest.raises(ValueError, match="https://HOST/OWNER/NAME"):
        hook.repository_address(f"repository-code: {address}\n")


def test_only_relative_links_are_changed(hook: ModuleType) -> None:
    def absolute(text: str) -> str:
        links: str = hook.absolute_links(text, ADDRESS, "v1")
        return links

    assert absolute("![A b](docs/a.webp)") == f"![A b]({ADDRESS}/raw/v1/docs/a.webp)"
    assert absolute("[a](docs/a.md#b) x") == f"[a]({ADDRESS}/blob/v1/docs/a.md#b) x"
    for link in ("[a](https://b.org/c)", "[a](#b)", "[a](mailto:b@c.org)", "`[x]` (y)"):
        assert absolute(link) == link


def build(root: Path, folder: Path, target: str) -> Path:
    """Build a distribution of a folder's project, and return its file."""
    command = (sys.executable, "-m", "hatchling", "build", "--target", target, "-d", folder)
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    [file] = folder.glob("*.whl" if target == "wheel" else "*.tar.gz")
    return file


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(CHECKOUT, tmp_path_factory.mktemp("sdist"), "sdist")


@pytest.fixture(scope="module")
def published(sdist: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """A wheel and an sdist, built from the sdist once its citation states an address."""
    folder = tmp_path_factory.mktemp("unpacked")
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, filter="data")
    [root] = folder.iterdir()
    with (root / "CITATION.cff").open("a", encoding="utf-8") as citation:
        citation.write(f'repository-code: "{ADDRESS}"\n')
    built = tmp_path_factory.mktemp("published")
    wheel = build(root, built, "wheel")
    # Of the sdist, not of the repository.
    (root / "PKG-INFO").unlink()
    return [wheel, build(root, built, "sdist")]


def metadata_of(distribution: Path) -> EmailMessage:
    """Return the core metadata of a wheel or an sdist, whose body is the README."""
    if distribution.suffix == ".whl":
        with zipfile.ZipFile(distribution) as wheel:
            [name] = [name for name in wheel.namelist() if name.endswith(".dist-info/METADATA")]
            content = wheel.read(name)
    else:
        with tarfile.open(distribution) as archive:
            [member] = [m for m in archive.getmembers() if re.fullmatch("[^/]+/PKG-INFO", m.name)]
            file = archive.extractfile(member)
            assert file is not None
            content = file.read()
    message = message_from_bytes(content, policy=policy.default.clone(utf8=True))
    assert isinstance(message, EmailMessage)
    return message


@pytest.mark.promises
def test_an_index_takes_both_and_says_where_the_project_is(published: list[Path]) -> None:
    check = (sys.executable, "-m", "twine", "--no-color", "check", "--strict")
    done = subprocess.run([*check, *published], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert done.stdout.count("PASSED") == len(published)
    for distribution in published:
        metadata = metadata_of(distribution)
        assert metadata["Version"] == __version__
        urls = [str(line).split(", ") for line in metadata.get_all("Project-URL", [])]
        assert {name for name, _ in urls} == {"Repository", "Documentation", "Changelog", "Issues"}
        assert all(url.startswith(ADDRESS) for _, url in urls)


@pytest.mark.promises
def test_the_readme_that_an_index_shows_leads_to_files_that_there_are(
    published: list[Path],
) -> None:
    for distribution in published:
        shown = markdown.render(metadata_of(distribution).get_content())
        assert shown is not None
        targets = re.findall(r'(?:href|src)="([^"]*)"', shown)
        assert sum("/raw/" in target for target in targets) >= 1
        for target in targets:
            if target.startswith(ADDRESS):
                path = re.sub(f"^{FILES}", "", target).partition("#")[0]
                assert (CHECKOUT / path).exists(), target
            else:
                assert target.startswith(("https://", "#")), target


@pytest.mark.promises
def test_without_an_address_no_link_is_made_up(sdist: Path) -> None:
    metadata = metadata_of(sdist)
    stated = "repository-code" in (CHECKOUT / "CITATION.cff").read_text("utf-8")
    assert stated == (metadata.get_all("Project-URL") is not None)


@pytest.mark.promises
def test_the_sdist_has_what_the_checks_need(sdist: Path) -> None:
    with tarfile.open(sdist) as archive:
        packed = {name.partition("/")[2] for name in archive.getnames()}
    for folder in ("tests", "app", "hexapods", "static", "docs", "benchmarks", ".ci"):
        assert any(name.startswith(f"{folder}/") for name in packed), folder
    assert {"Makefile", "pyproject.toml", "requirements-dev.lock", "package-lock.json"} <= packed
    assert not [name for name in packed if re.match(r"(\.venv|node_modules|build|\.git)/", name)]
