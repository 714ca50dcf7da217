"""Tests in several processes: the order in which they are handed out."""

from itertools import groupby

from xdist.scheduler import LoadScopeScheduling


class FileByFile(LoadScopeScheduling):  # type: ignore[misc]  # without types, as all of xdist
    """Hands out consecutive tests of one file together, and all in the order of the list.

    The tests of a file so share its fixtures. As one process gets no test that stands before the
    ones that it has had, those that stand last in the list come last in each process.
    """

    def schedule(self) -> None:
        """Split the list of tests, which all processes have in common, and hand out the first."""
        self.config.option.loadscopereorder = False
        tests = next(iter(self.registered_collections.values()))
        self._parts = {
            test: f"{number} {file}"
            for number, (file, together) in enumerate(groupby(tests, key=_file))
            for test in together
        }
        super().schedule()

    def _split_scope(self, nodeid: str) -> str:
        return self._parts[nodeid]


def _file(nodeid: str) -> str:
    return nodeid.partition("::")[0]
