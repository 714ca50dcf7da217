"""The commands `export` and `import`."""

from collections.abc import Mapping

COMMANDS: Mapping[str, str] = {
    "export": "app.features.archives.export_command:export_runs",
    "import": "app.features.archives.import_command:import_archive",
}
