"""The dashboard and the models are found in a checkout and in a package, and sent as code alone."""

from pathlib import Path

import pytest

from hexapods import assets

CHECKOUT = Path(__file__).parent.parent


def test_a_checkout_has_them_at_its_top_level() -> None:
    assert assets.static_dir() == CHECKOUT / "static"
    assert assets.models_dir() == CHECKOUT / "models"


def test_an_installed_package_prefers_its_own(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    package = tmp_path / "hexapods"
    (package / "_static").mkdir(parents=True)
    (tmp_path / "static").mkdir()
    monkeypatch.setattr(assets, "_PACKAGE", package)

    assert assets.static_dir() == package / "_static"


def test_a_broken_installation_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(assets, "_PACKAGE", tmp_path / "hexapods")

    with pytest.raises(FileNotFoundError, match="incomplete"):
        assets.models_dir()


@pytest.mark.parametrize(
    ("script", "sent"),
    [
        ("// Why.\nact();\n", "\nact();\n"),
        ("  /** Of it.\n   * More. */\n  act();\n", "\n\n  act();\n"),
        ("act(); // why\n", "act(); // why\n"),
        ("/** @type {A} */ (a).b();\n", "/** @type {A} */ (a).b();\n"),
        ('const a = "http://x";\n', 'const a = "http://x";\n'),
    ],
)
def test_comments_that_have_their_lines_to_themselves_are_left_out(script: str, sent: str) -> None:
    assert assets.as_sent(Path("a.js"), script.encode()) == sent.encode()


def test_what_others_have_written_keeps_its_licence() -> None:
    script = b"/* The MIT License */\nact();\n"
    assert assets.as_sent(Path("static/vendor/a.js"), script) == script
