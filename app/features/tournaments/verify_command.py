"""The part of `hexapods verify` that repeats files of tournaments."""

import json
from typing import TYPE_CHECKING

from app.cli.exit_codes import FAILED
from app.cli.terminal import progress, show_table
from app.cli.verifier import Verifier, VerifyOptions
from hexapods.agents.appearance import name_of
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import to_json
from hexapods.domain.text import visible

if TYPE_CHECKING:
    from hexapods.tournaments.tournament_file import TournamentFile


def _verify(data: bytes, file: str, options: VerifyOptions) -> int:
    if options.sample is not None:
        raise InvalidInput("--sample is for score files of benchmarks; leave it out")
    from hexapods.tournaments.tournament_file import read_file  # noqa: PLC0415
    from hexapods.tournaments.verification import verification, version_note  # noqa: PLC0415

    tournament = read_file(data, file)
    with progress("draws") as bar:
        task = bar.add_task("judging again", total=None)
        outcome = verification(
            tournament,
            options.workers,
            lambda done, total: bar.update(task, completed=done, total=total),
        )
    note = version_note(tournament)
    differences = outcome.differences
    is_rounded = note is not None and outcome.rounding is not None
    if options.as_json:
        shown = {
            "title": tournament.title,
            "repeats": not differences,
            "ranks_hold": outcome.ranks_hold,
            "rounding": outcome.rounding,
            "differences": differences,
            "version_note": note,
            "standings": [to_json(standing) for standing in tournament.standings],
        }
        print(json.dumps(shown))
        return FAILED if differences and not is_rounded else 0
    _show_ranking(tournament)
    if outcome.rounding is not None:
        print(outcome.rounding)
    for sentence in () if is_rounded else differences:
        print(sentence)
    if differences and outcome.rounding is None and outcome.ranks_hold is not None:
        print(f"The ranks {'hold' if outcome.ranks_hold else 'do not hold'}.")
    if note is not None:
        print(note)
    if is_rounded:
        print(f"{file} repeats but for the last digits of distances.")
        return 0
    if differences:
        print(f"{file} does not repeat: see the differences above.")
        return FAILED
    judged = f"{len(tournament.entries)} entries on {tournament.rules.draws} draws"
    print(f"{file} repeats to the last digit: {judged}.")
    return 0


def _show_ranking(tournament: "TournamentFile") -> None:
    """Print the standings as the file has them."""
    entries = {entry.number: entry for entry in tournament.entries}
    names = {number: f"{entry.name} ({number})" for number, entry in entries.items()}
    rows = []
    for standing in tournament.standings:
        entered = entries[standing.number].entry if standing.number in entries else None
        rows.append(
            (
                _ranks(standing.best_rank, standing.worst_rank),
                names.get(standing.number, f"({standing.number})"),
                "" if entered is None else visible(name_of(entered.agent, entered.settings)),
                f"{standing.iqm_m:.3f}",
                f"{standing.low_m:.3f}–{standing.high_m:.3f}",
                str(standing.failures or ""),
                ", ".join(str(other) for other in standing.not_separable) or "–",
            )
        )
    head = ("rank", "name", "agent", "IQM m", "95\u00a0%", "failed", "not separable from")
    show_table(tournament.title, head, rows, text=(1, 2, 6))


def _ranks(best: int, worst: int) -> str:
    return str(best) if best == worst else f"{best}–{worst}"


VERIFIER = Verifier(
    thing="a tournament",
    file="file of a tournament that has ended",
    origin="that of a tournament's page",
    docs="docs/tournaments.md",
    recognizes=lambda content: "standings" in content,
    verify=_verify,
)
