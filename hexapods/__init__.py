"""Hexapods that learn to walk by tabular Q-learning and race against look-ahead search.

    import hexapods as hx

    q = hx.train("q-learning", gait="left-right-origin", steps=500, seed=0)
    race = hx.race([q, "greedy", hx.lane("look-ahead", depth=3)], world="ice")

`train`, `iter_train`, `evaluate`, `race`, `lane`, `experiment` and `load` are what the dashboard
and the command line run; `Robot`, `Gait`, `World` and the agents are what they are given. All are
loaded when the first of them is used. `hexapods.environment` is the Gymnasium environment.

Modules beside the packages, each of which has a map in its docstring:

- `__main__`: `python -m hexapods`, the command of the dashboard.
- `public`: the names of `hx`. Verbs and their results: `practice`, `changes`, `trainings`; `races`,
  `race_tables`; `repetition`, `comparisons`; `benchmarks`; `viewing`; `policies`,
  `result_table`. `arguments`: what a person may write for an agent, a robot or a world.
  `interruption`: Ctrl-C.
- `assembly`: from a config to a simulator and agents.
- `assets`: where models, page and documents are; `offline_page`: parts of the page in one file;
  `files`: atomic writes and locks; `machine`: cores and memory; `extras`: optional packages;
  `version`: of the product.
- `processes`: start, set-up, watch and end of processes; `system_processes`: what operating systems
  do differently with them; `clean_start`: they do not import the program that starts them;
  `fork_server`: from which Linux forks them; `fork_server_end`: no folder is left; `worker_pool`:
  their executor.
"""

import importlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from hexapods.version import __version__ as __version__

if TYPE_CHECKING:
    from hexapods.public import *  # noqa: F403

if not TYPE_CHECKING:  # else every name would pass for one of its names

    def __getattr__(name: str) -> Any:
        """Load the public names.

        Raises:
            AttributeError: if there is no such name; the message names the functions.
        """
        if name.startswith("_") and name != "__all__":  # which `import *` and `help` ask for
            raise AttributeError(f"module 'hexapods' has no attribute {name!r}")
        public = _public_names()
        if name == "__all__":
            return list(public)
        if name not in public:
            functions = ", ".join(name for name in public if name.islower())
            raise AttributeError(f"hexapods has no {name!r}; its functions: {functions}")
        value = globals()[name] = public[name]
        return value

    def __dir__() -> list[str]:
        """Return the public names, and no modules that are loaded."""
        return ["__version__", *_public_names()]


def _public_names() -> Mapping[str, Any]:
    names = vars(importlib.import_module("hexapods.public"))
    return {name: names[name] for name in sorted(names) if not name.startswith("_")}
