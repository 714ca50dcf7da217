"""Score files: config, results and scores of a benchmark, as JSON that anyone can repeat."""

import json
from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

from hexapods.benchmarking.config import BenchmarkConfig
from hexapods.benchmarking.protocol import PLAIN_SEED, PROTOCOLS, BestKnown
from hexapods.benchmarking.runs import BenchmarkResult, BenchmarkRun, TaskPlan
from hexapods.benchmarking.scores import scores_of
from hexapods.domain.checks import check_format
from hexapods.domain.errors import DamagedFile, HexapodError, OtherFormat, UnknownName
from hexapods.domain.json_lists import check_lists
from hexapods.domain.records import from_json, to_json
from hexapods.domain.settings import complete
from hexapods.domain.text import visible
from hexapods.experiments.worker import versions
from hexapods.machine import description, instructions
from hexapods.runs.config import agent_settings

FORMAT = 1
MAX_BYTES = 32 << 20
_MAX_REASON = 1_000
_AGENT = ("observation", "settings")
_ROW = "| {} | {} | {} | {} | {} | {} |"
HEAD = _ROW.format("agent", "protocol", "seeds", "score", "by steps of practice", "failed runs")
"""Head of the table to which `row_of` is a line."""


def score_content(
    config: BenchmarkConfig,
    plans: Sequence[TaskPlan],
    results: Mapping[BenchmarkRun, BenchmarkResult],
    best_known: Mapping[str, BestKnown | str],
) -> dict[str, Any]:
    """Return the content of a score file; arguments as of `scores_of`."""
    plain = to_json(config)
    return {
        "format": FORMAT,
        "protocol": config.protocol,
        "agent": {"name": config.agent, **{name: plain[name] for name in _AGENT}},
        "is_whole_protocol": config.is_whole,
        "seeds": config.seeds,
        "seed": config.seed,
        "budgets": list(config.budgets),
        **scores_of(config, plans, results, best_known),
        "versions": own_versions(),
    }


def own_versions() -> dict[str, str]:
    """Return the versions, platform and kind of processor on which results depend here."""
    platform = str(description()["platform"])
    return {**versions(), "platform": platform, "processor": instructions()}


def encode(content: Mapping[str, Any]) -> bytes:
    """Encode the content of a score file as JSON."""
    return json.dumps(content, allow_nan=False, indent=1).encode() + b"\n"


def decode(data: bytes, name: str) -> dict[str, Any]:
    """Decode a score file. `verification` checks whether its results repeat.

    Args:
        data: content of the file.
        name: name of the file, for messages.

    Raises:
        UnknownName: if this version does not know its protocol.
        OtherFormat: if it is of another version.
        DamagedFile: if it is no score file.
    """
    try:
        if len(data) > MAX_BYTES:
            raise ValueError(f"it has more than {MAX_BYTES:,} bytes")
        check_lists(data)
        content = json.loads(data, parse_constant=_refuse)
        check_format(name, content["format"], FORMAT)
        if content["protocol"] not in PROTOCOLS:
            raise UnknownName("protocol", content["protocol"], PROTOCOLS)
        config_of(content)
        results_of(content)
    except (UnknownName, OtherFormat):
        raise
    except (HexapodError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        why = {KeyError: f"it lacks {error}", RecursionError: "it is nested too deeply"}
        reason = why.get(type(error), str(error))
        raise DamagedFile(
            f"{name} is no score file that can be read: {visible(reason)[:_MAX_REASON]}"
        ) from error
    return dict(content)


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is no number in JSON")


def config_of(content: Mapping[str, Any]) -> BenchmarkConfig:
    """Return the config of a score file.

    Raises:
        HexapodError, ValueError, TypeError, KeyError: if it has none.
    """
    agent = content["agent"]
    # A later version may have added a setting, of which the default is what was there before.
    settings = complete(agent_settings(agent["name"]), agent["settings"], agent["name"])
    plain = {
        **{name: content[name] for name in ("protocol", "budgets", "seeds", "seed")},
        "observation": agent["observation"],
        "settings": dict(settings),
        "agent": agent["name"],
        "tasks": [task["name"] for task in content["tasks"]],
    }
    return from_json(BenchmarkConfig, json.dumps(plain).encode(), strict=True)


def results_of(content: Mapping[str, Any]) -> dict[BenchmarkRun, BenchmarkResult]:
    """Return the results of a score file by run.

    Raises:
        ValueError, TypeError, KeyError: if it has none.
    """
    results = {}
    for task in content["tasks"]:
        errors = {(error["steps"], error["seed"]): str(error["error"]) for error in task["errors"]}
        for entry in task["budgets"]:
            for number, distance_m in enumerate(entry["distances_m"]):
                run = BenchmarkRun(str(task["name"]), int(entry["steps"]), number)
                reason = errors.get((run.budget, number))
                results[run] = BenchmarkResult(float(distance_m), reason)
    return results


def row_of(content: Mapping[str, Any]) -> str:
    """Return a score file as a line of a table in Markdown, whose head is `HEAD`."""
    agent, aggregate = content["agent"], content["aggregate"]
    name = visible(agent["name"])
    settings = _differing(agent)
    by_budget = [
        _score_text(entry) if entry["steps"] == 0 else f"{entry['steps']:,}: {_score_text(entry)}"
        for entry in aggregate["budgets"]
    ]
    failed = sum(error["seed"] is not None for task in content["tasks"] for error in task["errors"])
    practises = aggregate["budgets"][0]["steps"] > 0
    return _ROW.format(
        f"`{name}`{f' ({settings})' if settings else ''}".replace("|", "\\|"),
        _protocol_text(content),
        content["seeds"],
        _score_text(aggregate),
        " · ".join(by_budget) if practises else "does not practise",
        failed,
    )


def _protocol_text(content: Mapping[str, Any]) -> str:
    """Return the protocol in words, with the parts that are left out or drawn anew."""
    name = str(content["protocol"])
    parts = []
    if not content["is_whole_protocol"]:
        tasks = ", ".join(task["name"] for task in content["tasks"])
        parts.append(f"part: {tasks}")
    if content["seed"] != PLAIN_SEED:
        parts.append(f"seed {content['seed']}")
    return f"{name} ({'; '.join(parts)})" if parts else name


def _differing(agent: Mapping[str, Any]) -> str:
    """Return the settings of an agent in words, without those of its defaults."""
    declared = agent_settings(agent["name"])
    differing = [
        f"{name} {value}"
        for name, value in agent["settings"].items()
        if name in declared and value != declared[name].default
    ]
    if agent["observation"] != BenchmarkConfig.observation:
        differing.append(str(agent["observation"]))
    return ", ".join(differing)


def _score_text(entry: Mapping[str, Any]) -> str:
    """Return a score as a percentage with its interval: `83 (81–85) %`."""
    value = f"{100 * entry['score']:.0f}"
    if entry["interval"] is None:
        return f"{value}\u00a0%"
    low, high = entry["interval"]
    return f"{value} ({100 * low:.0f}–{100 * high:.0f})\u00a0%"
