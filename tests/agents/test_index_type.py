"""Learners work where NumPy's index type has 32 bits, as on WebAssembly and 32-bit systems.

There NumPy refuses to take 64-bit integers for counts and indices, as it refuses unsigned ones
here: in a process in which `np.int64` is unsigned, what would fail there fails.
"""

import subprocess
import sys
from pathlib import Path

from hexapods.agents.registry import BUILT_IN, learns

PROGRAM = """
import sys
import numpy
import hexapods as hx

class Unsigned:
    int64 = numpy.uint64

    def __getattr__(self, name):
        return getattr(numpy, name)


hx.race(["greedy"], simulator="kinematic", steps=1)  # imports what is imported where it is needed
for name, module in list(sys.modules.items()):
    if name.startswith("hexapods.") and hasattr(module, "np"):
        module.np = Unsigned()


for agent in sys.argv[1:]:
    walk = {"gait": "left-right-origin", "simulator": "kinematic"}
    hx.train(agent, **walk, steps=40, seed=3)
    print(agent)
"""


def test_learners_use_no_64_bit_integers_as_indices() -> None:
    names = [name for name in BUILT_IN if learns(name)]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *names],
        cwd=Path(__file__).parents[2],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.split() == names, done.stderr
