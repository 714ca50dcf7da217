"""The commands `experiment`, `sweep`, `compare` and `figure`."""

from collections.abc import Mapping

COMMANDS: Mapping[str, str] = {
    name: f"app.features.experiments.{name}_command:{name}"
    for name in ("experiment", "sweep", "compare", "figure")
}
