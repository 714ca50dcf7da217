"""`hexapods doctor`: looks at this machine and says what to do; changes nothing."""

import argparse
import json
import sys

from app.cli.checkup import examine
from app.cli.runs import add_data


def add_to(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command."""
    parser = commands.add_parser("doctor", help="check this machine", description=__doc__)
    add_data(parser)
    parser.add_argument("--json", action="store_true", help="for programs")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Check everything; 0 if all is well, else 1."""
    # A terminal that cannot show a tick is no reason to end.
    sys.stdout.reconfigure(errors="replace")  # type: ignore[union-attr]
    findings = []
    for finding in examine(options.data):
        findings.append(finding)
        if not options.json:
            print(f"{'✓' if finding.ok else '✗'} {finding.name}: {finding.said}", flush=True)
    ok = all(finding.ok for finding in findings)
    if options.json:
        print(json.dumps({"ok": ok, "checks": [finding._asdict() for finding in findings]}))
    return 0 if ok else 1
