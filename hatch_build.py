"""Metadata of the distributions that follows from the address of the repository.

The address is stated once: `repository-code` of CITATION.cff. While it is not, the distributions
have no links to it, and the README keeps those that are relative.
"""

import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

CITATION = "CITATION.cff"
_ADDRESS = re.compile(r"^repository-code:(.*)$", re.MULTILINE)
_VALID = re.compile(r"https://(?P<host>[a-z0-9-]+(\.[a-z0-9-]+)+)(/[\w.~-]+)+")
_RESERVED = re.compile(r"(^|\.)(example(\.\w+)?|invalid|test|localhost)$")
"""Hosts that stand for none (RFC 2606)."""
_LINK = re.compile(r"(?P<is_image>!?)\[(?P<text>[^]]*)\]\((?P<target>[^)\s]+)\)")
_IS_ABSOLUTE = re.compile(r"[a-z]+:|#")


class RepositoryLinks(MetadataHookInterface):
    """Adds the project's links, and a README whose links and images lead to the repository."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set `readme` and `urls` of a project's metadata, which has its version."""
        root = Path(self.root)
        readme = (root / "README.md").read_text("utf-8")
        address = repository_address((root / CITATION).read_text("utf-8"))
        metadata["urls"] = {}
        if address is not None:
            tag = f"v{metadata['version']}"
            readme = absolute_links(readme, address, tag)
            metadata["urls"] = {
                "Repository": address,
                "Documentation": f"{address}/blob/{tag}/docs/index.md",
                "Changelog": f"{address}/blob/{tag}/CHANGELOG.md",
                "Issues": f"{address}/issues",
            }
        metadata["readme"] = {"content-type": "text/markdown", "text": readme}


def get_metadata_hook() -> type[MetadataHookInterface]:
    """Return the hook: Hatchling asks for it by this name."""
    return RepositoryLinks


def repository_address(citation: str) -> str | None:
    """Return the address of the repository that a citation file states; None if it states none.

    Raises:
        ValueError: if it is no address of a repository.
    """
    stated = _ADDRESS.search(citation)
    if stated is None:
        return None
    address = stated[1].strip().strip("\"'")
    valid = _VALID.fullmatch(address)
    if valid is None or _RESERVED.search(valid["host"]):
        raise ValueError(
            f"repository-code of {CITATION} is {address!r}: it must be the address of the "
            "repository, https://HOST/OWNER/NAME without a slash at its end, or not be there"
        )
    return address


def absolute_links(markdown: str, address: str, tag: str) -> str:
    """Return Markdown whose relative links lead to files of a repository, as a tag has them.

    Args:
        markdown: text of a page at the root of the repository.
        address: of the repository.
        tag: of the version.
    """

    def absolute(link: re.Match[str]) -> str:
        if _IS_ABSOLUTE.match(link["target"]):
            return link[0]
        kind = "raw" if link["is_image"] else "blob"
        return f"{link['is_image']}[{link['text']}]({address}/{kind}/{tag}/{link['target']})"

    return _LINK.sub(absolute, markdown)
