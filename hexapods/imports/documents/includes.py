"""Follow `<include>` of MJCF within an upload, by MuJoCo's rules.

The file is named by its path beside the main document. What is in its root takes the place of the
`<include>`, and each file may be included once, so that no circle is possible.
"""

from collections.abc import Callable
from dataclasses import replace

from hexapods.domain.errors import DamagedFile
from hexapods.imports.documents.expressions import Budget, InvalidExpression
from hexapods.imports.documents.upload import Upload, last_part
from hexapods.imports.documents.xml import MAX_PARSED, Element
from hexapods.imports.notes import quoted

_MAX_FILES = 100


class Includes:
    """Follows the includes of documents of one upload.

    Args:
        upload: the files.
        parse: returns the root of a document by its path.
        budget: of operations.
    """

    def __init__(self, upload: Upload, parse: Callable[[str], Element], budget: Budget) -> None:
        self._upload, self._parse, self._budget = upload, parse, budget

    def followed(self, path: str, root: Element) -> tuple[Element, frozenset[str]]:
        """Return a document with what it includes, and the paths of the included documents.

        Raises:
            DamagedFile: if a file is missing, damaged, or included twice, or they are too many.
        """
        if next(root.all("include"), None) is None:
            return root, frozenset()
        paths, count = {path}, 0

        def copied(element: Element, file: str) -> Element:
            nonlocal count
            count += 1
            self._budget.spend()
            if count > MAX_PARSED:
                raise DamagedFile(f"with what it includes it has more than {MAX_PARSED:,} elements")
            return replace(element, children=inside(element, file), file=file)

        def inside(element: Element, file: str) -> list[Element]:
            children: list[Element] = []
            for child in element:
                if child.tag != "include":
                    children.append(copied(child, file))
                    continue
                include = replace(child, file=file)
                included = self._included(include, path, file or path)
                if included in paths:
                    raise DamagedFile(
                        f"{include.place}: {quoted(included)} is included already; MuJoCo allows "
                        "it once"
                    )
                paths.add(included)
                if len(paths) > _MAX_FILES:
                    raise DamagedFile(f"it includes more than {_MAX_FILES} files")
                children += inside(self._parse(included), included)
            return children

        try:
            return copied(root, ""), frozenset(paths - {path})
        except InvalidExpression as error:  # of the budget
            raise DamagedFile(f"{quoted(path)}: {error}") from error

    def _included(self, include: Element, main: str, file: str) -> str:
        """Return the path of the file that an element includes."""
        wanted = include.attributes.get("file", "")
        # A file beside the main document comes first, one beside the including document second.
        found = self._upload.find(wanted, main)
        for document in (main, file):
            if beside := self._upload.beside(wanted, document):
                found = beside
                break
        if found is not None:
            return found
        name = quoted(last_part(wanted))
        if self._upload.is_zip:
            raise DamagedFile(f"{include.place}: {name} is not in the zip; add it")
        raise DamagedFile(
            f"{include.place}: it includes {name}, which is another file: give both in a zip or a "
            'folder, or make one document of them: python -c "import mujoco; '
            f"print(mujoco.MjSpec.from_file('{quoted(last_part(main))}').to_xml())\""
        )
