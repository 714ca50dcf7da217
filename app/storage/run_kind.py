"""Kinds of runs: trainings and races, and those that features add as a value.

A feature adds a kind by a module `app/features/NAME/run_kind.py` with an `AddedKind` as `KIND`, and
another package by an entry point of the group `hexapods.run_kinds` that names such a module. The
command line and worker processes read it too, so it does not import FastAPI.
"""

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, cast

from app.feature_modules import feature_modules
from app.settings import read_without
from hexapods.runs.config import TrainingConfig
from hexapods.runs.race_config import RaceConfig
from hexapods.runs.results import RaceResult, TrainingResult

if TYPE_CHECKING:
    from sqlalchemy import Table

    from app.storage.database.store import RunStore
    from app.storage.run import Run

GROUP = "hexapods.run_kinds"
"""Entry-point group of kinds of runs of features of other packages."""
Rows = Mapping["Table", Sequence[Mapping[str, Any]]]
"""Rows of a run in tables beside that of runs, by table, without the column `run_id`."""


class RunKind:
    """A kind of run.

    Attributes:
        name: of the kind, as runs have it.
        config: class of its configs, a dataclass.
        result: class of its results, a dataclass.
        counted: what `done` and `total` of a run count.
    """

    name: ClassVar[str]
    config: ClassVar[type[Any]]
    result: ClassVar[type[Any]]
    counted: ClassVar[str] = "steps"


class AddedKind(RunKind, ABC):
    """A kind of run that a feature adds. One object is made of it.

    A run of it is no walk: it has no recording, and is not shown on the stage.
    """

    @abstractmethod
    def checked_total(self, config: Any) -> int:
        """Check that a run with this config can be started; return its total.

        Raises:
            HexapodError: if it cannot.
        """

    @abstractmethod
    def has_made_name(self, run: "Run") -> bool:
        """Whether the name of a run is the one that is made of its config."""

    @abstractmethod
    def task(self, run: "Run", store: "RunStore") -> Any:
        """Return the `app.jobs.messages.AddedTask` of a run, whether it starts or resumes.

        Raises:
            DamagedFile: if what is stored of it is damaged.
        """

    @abstractmethod
    def job_class(self) -> type[Any]:
        """Return the subclass of `app.jobs.job.Job` that takes the messages of its process."""

    @abstractmethod
    def response_model(self) -> type[Any]:
        """Return the model of a run in answers, a subclass of `app.events.run_view.RunView`."""

    def view(self, run: "Run") -> Mapping[str, Any]:
        """Return further members of the response model of a run, by name."""
        del run
        return {}

    def outcome(self, result: Any) -> str:
        """Return a result in a few words; empty for a kind without such words."""
        del result
        return ""

    # ---- in an archive

    @abstractmethod
    def texts(self, run: "Run", store: "RunStore") -> Mapping[str, bytes]:
        """Return the members of a run's archive that are made of its rows, by name.

        Raises:
            Damaged: if the rows are damaged.
        """

    @abstractmethod
    def file_names(self, run: "Run") -> Iterable[str]:
        """Return the names of a run's artifacts that are members of its archive."""

    @abstractmethod
    def is_member(self, name: str) -> bool:
        """Whether an archive may have a member of this name."""

    @abstractmethod
    def take_members(self, run: "Run", members: dict[str, bytes], label: str) -> Rows:
        """Validate an imported run's members, and remove those that `texts` made.

        Args:
            run: the run, without its content.
            members: of its archive, by name.
            label: name of the archive for error messages.

        Returns:
            the rows of the members that were removed.

        Raises:
            DamagedFile: if one is unexpected, malformed or missing.
        """


class _Training(RunKind):
    """A training."""

    name, config, result = "training", TrainingConfig, TrainingResult


class _Race(RunKind):
    """A race."""

    name, config, result = "race", RaceConfig, RaceResult


WALKS: tuple[str, ...] = (_Training.name, _Race.name)
"""Names of the kinds of the core: walks of robots, step by step, which are recorded and shown."""


@cache
def run_kinds() -> Mapping[str, RunKind]:
    """Return all kinds that are installed, by name: those of the core first."""
    kinds = [_Training(), _Race(), *_of_features().values()]
    return {kind.name: kind for kind in kinds}


def kinds_without(features: Collection[str]) -> frozenset[str]:
    """Return the names of all kinds but those of features that are left out."""
    left_out = {kind.name for name, kind in _of_features().items() if name in features}
    return frozenset(run_kinds().keys() - left_out)


def with_article(kind: str) -> str:
    """Return the name of a kind with its article: `a race`."""
    return f"an {kind}" if kind[0] in "aeiou" else f"a {kind}"


def added_kind(name: str) -> AddedKind | None:
    """Return a kind by its name; None if it is one of the core's."""
    kind = run_kinds()[name]
    return kind if isinstance(kind, AddedKind) else None


def added_kinds() -> Sequence[AddedKind]:
    """Return the kinds that features add."""
    return [kind for kind in run_kinds().values() if isinstance(kind, AddedKind)]


@cache
def _of_features() -> Mapping[str, AddedKind]:
    """Return the kinds that features add, by the feature's name."""
    return {
        feature: cast("AddedKind", module.KIND)
        for feature, _, module in feature_modules("run_kind", GROUP, read_without())
    }
