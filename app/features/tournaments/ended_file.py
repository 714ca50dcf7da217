"""A tournament that has ended as a file, which anyone can repeat by `hexapods verify`."""

from collections.abc import Callable

from app.features.tournaments.tournament import Tournament, TournamentEntry
from app.features.tournaments.tournaments import Tournaments
from hexapods.domain.errors import DamagedFile
from hexapods.tournaments.tournament_file import JudgedEntry, TournamentFile, write_file


def file_of(
    tournaments: Tournaments, tournament: Tournament, name_of: Callable[[TournamentEntry], str]
) -> bytes:
    """Return the file of a tournament.

    Args:
        tournaments: those of the server.
        tournament: one that has ended.
        name_of: returns the name of an entry's entrant, as others may see it.

    Raises:
        Conflict: if it has not ended.
        DamagedFile: if what is stored of it cannot be read.
        TooLong: if it is too large.
    """
    tournament.check_ended()
    entries = tuple(
        JudgedEntry(
            number=entry.number, name=name_of(entry), entry=entry.entry, judgements=entry.in_order()
        )
        for entry in tournament.judged
    )
    if {entry.number for entry in entries} != {entry.number for entry in tournament.standings}:
        raise DamagedFile(
            "what the database holds of this tournament's entries is damaged; put a backup back"
        )
    digests = dict.fromkeys(entry.entry.table for entry in entries if entry.entry.table is not None)
    file = TournamentFile(
        title=tournament.title,
        rules=tournament.rules,
        commitment=tournament.commitment,
        secret=tournament.secret,
        entries=entries,
        standings=tuple(tournament.standings),
        tables={digest: tournaments.table(tournament, digest) for digest in digests},
        robots=tournament.outcome["robots"],
        versions=tournament.outcome["versions"],
        machine=tournament.outcome["machine"],
    )
    return write_file(file)
