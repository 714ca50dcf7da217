"""What the paper says, and whether the trials bear it out."""

from collections.abc import Mapping, Sequence

from app.experiments.claims.figure4 import FIGURE4_CLAIMS
from app.experiments.claims.judging import Claim
from app.experiments.claims.sweep import SWEEP_CLAIMS
from app.experiments.claims.table1 import TABLE1_CLAIMS

CLAIMS_OF: Mapping[str, Sequence[Claim]] = {
    "table1": TABLE1_CLAIMS,
    "figure4": FIGURE4_CLAIMS,
    "sweep": SWEEP_CLAIMS,
}
