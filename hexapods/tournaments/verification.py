"""Repeat a tournament from its file, and list the differences."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Future, as_completed
from dataclasses import fields
from itertools import chain
from typing import NamedTuple

from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.domain.text import visible
from hexapods.experiments.local_workers import local_pool
from hexapods.experiments.worker import difference
from hexapods.machine import cores
from hexapods.runs.tables import Checkpoint, from_bytes
from hexapods.tournaments.entry import EntryConfig, check_table, completed, references, training_of
from hexapods.tournaments.judging import Judgement, judge
from hexapods.tournaments.ranking import RankedEntry
from hexapods.tournaments.rules import Draw, commitment_of, draws_of
from hexapods.tournaments.tournament_file import (
    PROBE,
    JudgedEntry,
    TournamentFile,
    own_versions,
    probe_m,
    standings_of,
)

MAX_LISTED = 3
"""Most differing draws of an entry that are listed one by one; of more, the number is given."""
Repeated = Mapping[int, Sequence[Judgement | str]]
"""Judgements of each draw by the entry's number; in place of a missing one, the reason."""


LAST_DIGITS_M = 1e-9
"""Distances that differ by no more differ by rounding: after 50 steps by less than a femtometre."""


class TournamentVerification(NamedTuple):
    """Outcome of repeating a tournament.

    Attributes:
        differences: sentences, one per difference; none if it repeats to the last bit.
        rounding: the same in a sentence, if nothing differs but the last digits of distances: from
            which step on, by how much, and that the ranks hold. None else.
        ranks_hold: whether each entry has the same ranks; None if they could not be compared.
    """

    differences: list[str]
    rounding: str | None
    ranks_hold: bool | None


def verify(
    tournament: TournamentFile,
    workers: int | None = None,
    on_judged: Callable[[int, int], object] = lambda done, total: None,  # noqa: ARG005
) -> list[str]:
    """Return the differences of a repeated tournament, a sentence each; see `verification`."""
    return verification(tournament, workers, on_judged).differences


def verification(
    tournament: TournamentFile,
    workers: int | None = None,
    on_judged: Callable[[int, int], object] = lambda done, total: None,  # noqa: ARG005
) -> TournamentVerification:
    """Repeat a tournament, and return the differences.

    Its secret is compared with its commitment, the references with those of every tournament, each
    judgement and each standing with the repeated one, to the last bit. A file cannot show which
    entries were left out of it.

    Args:
        tournament: the tournament.
        workers: number of processes; None for one per core.
        on_judged: called with the numbers of draws of entries that were judged, and of all.

    Raises:
        InvalidInput: if the number of workers is not valid.
        ClusterLost: if no process can be started.
    """
    if workers is not None and workers < 1:
        raise InvalidInput(f"workers must be at least 1, not {workers}")
    try:
        draws = draws_of(tournament.rules, tournament.secret)
    except InvalidInput as error:
        return TournamentVerification([f"The draws cannot be repeated: {error}."], None, None)
    differences = [*_secret_differences(tournament), *_reference_differences(tournament)]
    tables: dict[int, Checkpoint | None] = {}
    for entry in tournament.entries:
        try:
            tables[entry.number] = _checked_table(entry.entry, tournament)
        except HexapodError as error:
            differences.append(f"{_name(entry)} cannot be judged: {visible(str(error))}.")
    judged = [entry for entry in tournament.entries if entry.number in tables]
    pending = len(judged) * len(draws)
    with local_pool(min(workers or cores(), max(1, pending))) as pool:
        futures = {
            entry.number: [
                pool.submit(judge, tournament.rules, entry.entry, draw, tables[entry.number])
                for draw in draws
            ]
            for entry in judged
        }
        for done, _ in enumerate(as_completed(chain(*futures.values())), start=1):
            on_judged(done, pending)
    repeated = {number: [_result(task) for task in tasks] for number, tasks in futures.items()}
    ranks_hold = _ranks_hold(tournament, repeated)
    largest_m = None if differences or not ranks_hold else _largest_m(judged, repeated)
    for entry in judged:
        differences += _judgement_differences(entry, draws, repeated[entry.number])
    differences += _standing_differences(tournament, repeated)
    rounding = None
    if differences and largest_m is not None and largest_m <= LAST_DIGITS_M:
        rounding = _rounding(tournament, largest_m, draws[0])
    return TournamentVerification(differences, rounding, ranks_hold)


def _ranks_hold(tournament: TournamentFile, repeated: Repeated) -> bool | None:
    """Whether order, ranks and failures are the same; None if some entry could not be judged."""
    judgements = _complete(repeated)
    if len(judgements) < len(tournament.entries):
        return None
    shown = [
        [
            (
                ranked.number,
                ranked.best_rank,
                ranked.worst_rank,
                ranked.not_separable,
                ranked.failures,
            )
            for ranked in s
        ]
        for s in (tournament.standings, standings_of(judgements))
    ]
    return shown[0] == shown[1]


def _largest_m(judged: Sequence[JudgedEntry], repeated: Repeated) -> float | None:
    """Return the largest difference of distances [m]; None if failures differ."""
    differences_m = [0.0]
    for entry in judged:
        if len(entry.judgements) != len(repeated[entry.number]):
            return None
        for in_file, again in zip(entry.judgements, repeated[entry.number], strict=True):
            if isinstance(again, str) or in_file.failure != again.failure:
                return None
            differences_m.append(abs(in_file.distance_m - again.distance_m))
    return max(differences_m)


def _rounding(tournament: TournamentFile, largest_m: float, draw: Draw) -> str:
    """Describe a difference in last digits: its size, and the first step of a walk that differs."""
    in_file = tournament.machine.get(PROBE)
    again = probe_m(tournament.rules, draw)
    step = None
    if isinstance(in_file, list) and len(in_file) == len(again):
        pairs = enumerate(zip(in_file, again, strict=True), start=1)
        step = next((number for number, (filed, repeated) in pairs if filed != repeated), 0)
    begins = {
        None: "the file does not tell from which step on",
        0: "the random walk on draw 1 is the same, so that they begin in practice or planning",
    }.get(step, f"the random walk on draw 1 differs from its step {step} on")
    return (
        f"Distances differ in their last digits alone, by at most {largest_m:.1g} m, and all "
        f"ranks hold; {begins}."
    )


def version_note(tournament: TournamentFile) -> str | None:
    """Return a sentence on versions that differ from the file's; None if results must be equal."""
    # Python is in the file, but results do not depend on it.
    filed = {name: version for name, version in tournament.versions.items() if name != "python"}
    other = difference(filed, own_versions())
    if other is None:
        return None
    return visible(f"This is {other}, by which results may differ in their last digits.")


def _secret_differences(tournament: TournamentFile) -> Iterator[str]:
    if commitment_of(tournament.secret) != tournament.commitment:
        yield (
            "The secret is not the one to which the tournament was committed at its beginning: its "
            "SHA-256 is another one."
        )


def _reference_differences(tournament: TournamentFile) -> Iterator[str]:
    by_number = {entry.number: entry.entry for entry in tournament.entries}
    try:
        usual = references(tournament.rules)
    except HexapodError as error:
        yield f"The references cannot be judged: {visible(str(error))}."
        return
    for number, expected in enumerate(usual):
        if number not in by_number:
            yield f"Entry {number}, the reference {expected.agent}, is missing."
        elif not _is_entry(by_number[number], expected, tournament):
            yield f"Entry {number} is not the reference {expected.agent} with its usual settings."


def _is_entry(entry: EntryConfig, expected: EntryConfig, tournament: TournamentFile) -> bool:
    """Whether an entry is the expected one; what its version did not know has the default."""
    try:
        return completed(entry, tournament.rules) == expected
    except HexapodError:  # the rules do not allow it, which is told with its judgements
        return False


def _checked_table(entry: EntryConfig, tournament: TournamentFile) -> Checkpoint | None:
    """Return the table of an entry; None if it has none.

    Raises:
        HexapodError: if the rules do not allow the entry or its table, or the table is not there.
    """
    training_of(entry, tournament.rules)
    if entry.table is None:
        return None
    data = tournament.table(entry.table)
    if data is None:
        raise InvalidInput(f"its table {entry.table} is not in the file")
    table = from_bytes(data, "its table")
    check_table(entry, tournament.rules, table)
    return table


def _result(future: "Future[Judgement]") -> Judgement | str:
    try:
        return future.result()
    except BrokenExecutor:
        return "the process that judged it has ended; is there too little memory?"
    except Exception as error:  # of an agent of a package that is missing or broken here
        return f"{type(error).__name__}: {error}"


def _judgement_differences(
    entry: JudgedEntry, draws: Sequence[Draw], repeated: Sequence[Judgement | str]
) -> Iterator[str]:
    if len(entry.judgements) != len(draws):
        yield (
            f"{_name(entry)} has {len(entry.judgements)} judgements in the file; the rules have "
            f"{len(draws)} draws."
        )
        return
    differing = [
        f"{_name(entry)}, draw {number} (seed {draw.seed}, {draw.world}): "
        f"{_text(in_file)} in the file, {_text(again)} repeated."
        for number, (draw, in_file, again) in enumerate(
            zip(draws, entry.judgements, repeated, strict=True), start=1
        )
        if in_file != again
    ]
    yield from differing[:MAX_LISTED]
    if len(differing) > MAX_LISTED:
        yield (
            f"{_name(entry)}: {len(differing) - MAX_LISTED} more of its {len(draws)} draws differ."
        )


def _standing_differences(tournament: TournamentFile, repeated: Repeated) -> list[str]:
    """Compare the standings with those of the repeated judgements."""
    judgements = _complete(repeated)
    if len(judgements) < len(tournament.entries):
        return ["The standings were not compared, as some entries could not be judged."]
    expected = {ranked.number: ranked for ranked in standings_of(judgements)}
    names = {entry.number: _name(entry) for entry in tournament.entries}
    in_file = {ranked.number: ranked for ranked in tournament.standings}
    differences = [
        f"{names[number]} has no standing." for number in expected if number not in in_file
    ]
    differences += [
        f"There is a standing of entry {number}, which is not there."
        for number in in_file
        if number not in expected
    ]
    for number, again in expected.items():
        if number in in_file:
            differences += _field_differences(names[number], in_file[number], again)
    order = [ranked.number for ranked in tournament.standings]
    if not differences and order != list(expected):
        differences.append(
            f"The standings are in the order {_listed(order)} in the file, {_listed(expected)} "
            "repeated."
        )
    return differences


def _complete(repeated: Repeated) -> dict[int, Sequence[Judgement]]:
    """Return the judgements of the entries that could be judged on all draws."""
    judgements: dict[int, Sequence[Judgement]] = {}
    for number, of_entry in repeated.items():
        done = [judgement for judgement in of_entry if isinstance(judgement, Judgement)]
        if len(done) == len(of_entry):
            judgements[number] = done
    return judgements


def _field_differences(name: str, filed: RankedEntry, expected: RankedEntry) -> Iterator[str]:
    for field in fields(RankedEntry):
        in_file, again = getattr(filed, field.name), getattr(expected, field.name)
        if in_file != again:
            yield (
                f"Standing of {name}: {field.name} is {in_file!r} in the file, {again!r} repeated."
            )


def _name(entry: JudgedEntry) -> str:
    return f"Entry {entry.number} ({entry.name})"


def _text(judgement: Judgement | str) -> str:
    """Describe a judgement, with all digits of its distance."""
    if isinstance(judgement, str):
        return f"not judged ({visible(judgement)})"
    if judgement.failure is not None:
        return f"failed ({visible(judgement.failure)})"
    return f"{judgement.distance_m!r} m"


def _listed(numbers: Iterable[int]) -> str:
    return ", ".join(map(str, numbers))
