"""The paper's claims, and their verdicts over many seeds.

- `cases`: the cases in which each claim is judged (one observation on one robot).
- `judging`: a claim, a finding in one case, and the verdict over all cases.
- `table1`, `figure4`, `sweep`, `groups`: the claims of each experiment; `gaits`: those about the
  gaits.
- `distance_to_paper`: the case whose distances are closest to the printed numbers.
"""

from collections.abc import Mapping, Sequence

from hexapods.experiments.claims.figure4 import FIGURE4_CLAIMS
from hexapods.experiments.claims.groups import GROUPS_CLAIMS
from hexapods.experiments.claims.judging import Claim
from hexapods.experiments.claims.sweep import SWEEP_CLAIMS
from hexapods.experiments.claims.table1 import TABLE1_CLAIMS

CLAIMS: Mapping[str, Sequence[Claim]] = {
    "table1": TABLE1_CLAIMS,
    "figure4": FIGURE4_CLAIMS,
    "sweep": SWEEP_CLAIMS,
    "groups": GROUPS_CLAIMS,
}
"""Claims by the name that presets refer to."""
