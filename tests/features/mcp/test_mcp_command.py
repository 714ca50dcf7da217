"""`hexapods mcp` spoken to by the library's own client, beside a real server."""

import asyncio
import sys
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from mcp import Client
from mcp.client.stdio import StdioServerParameters

from tests.cli.running import ROOT, in_process, refusal
from tests.features.needing import needs
from tests.served import Served
from tests.storage.stores import opened

TOKEN = "a-token-for-tests"
EXPERIMENT = "00000000000e1"
BODY = {"simulator": "kinematic", "steps": 60, "evaluate_every": 0}
READING = {"list_runs", "explain_step", "compare_settings", "compare_trainings"}
STARTING = {"start_training", "start_race"}

pytestmark = needs("experiments", "explanations")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, Path]]:
    from tests.features.experiments.ended_experiments import ended_experiment

    data = tmp_path_factory.mktemp("data")
    with opened(data, None) as store:
        ended_experiment(store, EXPERIMENT)
    served = Served(data, HEXAPODS_TOKEN=TOKEN)
    served.client.headers["Authorization"] = f"Bearer {TOKEN}"
    yield served, data
    served.end()


def spoken(
    data: Path, work: Callable[[Client], Awaitable[None]], *options: str, token: str = TOKEN
) -> None:
    """Start the command, and speak to it as an assistant does."""
    command = StdioServerParameters(
        command=sys.executable,
        args=["-m", "app.cli", "mcp", "--data", str(data), *options],
        env={"HEXAPODS_TOKEN": token, "PYTHONPATH": str(ROOT)},
        cwd=str(data),
    )

    async def speak() -> None:
        async with Client(command) as client:
            await work(client)

    asyncio.run(speak())


async def answer(client: Client, tool: str, **arguments: Any) -> Any:
    result = await client.call_tool(tool, arguments)
    assert not result.is_error, result.content
    return result.structured_content


async def error(client: Client, tool: str, **arguments: Any) -> str:
    result = await client.call_tool(tool, arguments)
    assert result.is_error, result.structured_content
    return " ".join(getattr(part, "text", "") for part in result.content)


def test_it_reads_what_the_page_shows_and_starts_nothing(server: tuple[Served, Path]) -> None:
    served, data = server
    runs = [
        served.in_state(served.start({**BODY, "seed": seed, "name": name}), "finished")
        for name in ("Slow", "Fast")
        for seed in (1, 2, 3)
    ]
    ids = [run["id"] for run in runs]
    explained = served.client.get(f"/api/v1/runs/{ids[0]}/explain?step=7").json()
    path = f"/api/v1/experiments/{EXPERIMENT}/comparison"

    async def work(client: Client) -> None:
        tools = {tool.name: tool for tool in (await client.list_tools()).tools}
        assert tools.keys() == READING
        for tool in tools.values():
            assert tool.annotations is not None
            assert tool.annotations.read_only_hint
            assert tool.output_schema
            assert tool.description
        listed = await answer(client, "list_runs", kind="training", limit=2)
        assert [run["id"] for run in listed["runs"]] == [ids[-1], ids[-2]]
        assert listed["runs"][0]["distance_m"] == runs[-1]["result"]["distance_m"]
        more = await answer(client, "list_runs", kind="training", cursor=listed["next_cursor"])
        assert [run["id"] for run in more["runs"]] == ids[3::-1]
        told = await answer(client, "explain_step", run_id=ids[0], step=7)
        for member in ("what", "why", "missed", "agent", "reward_m", "step"):
            assert told[member] == explained[member], member
        assert told["rule"] == explained["update"]["direct"]["numbers"]
        compared = await answer(client, "compare_trainings", a=ids[:3], b=ids[3:])
        assert (compared["difference"], compared["is_paired"]) == (0, True)
        assert (compared["a"], compared["seeds_b"]) == ("Slow", 3)
        alone = await answer(client, "compare_trainings", a=ids[:1], b=ids[1:2])
        expected = runs[0]["result"]["distance_m"] - runs[1]["result"]["distance_m"]
        assert alone["difference"] == pytest.approx(expected)
        assert alone["low"] is None
        settings = ["q-learning", "greedy"]
        of_page = served.client.get(path, params=dict(zip("ab", settings, strict=True))).json()
        of_tool = await answer(
            client, "compare_settings", experiment_id=EXPERIMENT, a=settings[0], b=settings[1]
        )
        assert of_tool["difference"] == of_page["difference"]["value"]
        assert (of_tool["low"], of_tool["ahead"]) == (
            of_page["difference"]["low"],
            of_page["ahead"],
        )

        assert "no run 'nothing'" in await error(client, "explain_step", run_id="nothing")
        assert "from 1 to 60" in await error(client, "explain_step", run_id=ids[0], step=99)
        assert "less than or equal to 50" in await error(client, "list_runs", limit=51)
        assert "kind must be" in await error(client, "list_runs", kind="walk")
        assert "start_race" in await error(client, "start_race", lanes=[{"agent": "greedy"}])

    spoken(data, work)


def test_it_starts_within_its_allowance(server: tuple[Served, Path]) -> None:
    served, data = server

    async def work(client: Client) -> None:
        tools = (await client.list_tools()).tools
        assert {tool.name for tool in tools} == READING | STARTING
        problem = {"simulator": "kinematic"}
        sentence = await error(client, "start_training", steps=201, **problem)
        assert "from 1 to 200 steps" in sentence
        sentence = await error(client, "start_training", agent="q-lerning", steps=50, **problem)
        assert "did you mean q-learning" in sentence
        started = await answer(
            client, "start_training", steps=80, settings={"alpha": 0.5}, name="Asked", **problem
        )
        assert (started["starts_left"], started["steps_left"]) == (1, 120)
        training = {"kind": "training", "id": started["run"]["id"]}
        view = served.in_state(training, "finished")
        assert (view["name"], view["config"]["settings"]["alpha"]) == ("Asked", 0.5)
        lanes = [{"agent": "q-learning", "training_id": training["id"]}, {"agent": "greedy"}]
        raced = await answer(client, "start_race", lanes=lanes, steps=50, **problem)
        assert (raced["starts_left"], raced["steps_left"]) == (0, 20)
        served.in_state({"kind": "race", "id": raced["run"]["id"]}, "finished")
        found = await answer(client, "list_runs", search=raced["run"]["id"])
        assert found["runs"][0]["winner"] in {"q-learning", "greedy"}
        assert "used up" in await error(client, "start_training", steps=5, **problem)

    spoken(data, work, "--starts", "2", "--steps", "200")


def test_errors_say_what_to_do(server: tuple[Served, Path], tmp_path: Path) -> None:
    async def without_server(client: Client) -> None:
        sentence = await error(client, "list_runs")
        assert "start it with `hexapods serve`" in sentence
        assert str(tmp_path) in sentence

    spoken(tmp_path, without_server)

    async def with_wrong_token(client: Client) -> None:
        runs = await answer(client, "list_runs")
        assert runs["runs"], "spectators may watch"
        sentence = await error(client, "start_training", steps=5)
        assert "set HEXAPODS_TOKEN" in sentence

    allowance = ("--starts", "1", "--steps", "9")
    spoken(server[1], with_wrong_token, *allowance, token="another-token-for-tests")
    for options, said in (
        (("--starts", "1"), "give --steps too"),
        (("--steps", "1"), "give --starts too"),
        (("--starts", "0", "--steps", "1"), "--starts must be from 1 to 1,000"),
    ):
        assert said in refusal("mcp", *options, folder=tmp_path, run=in_process)


def test_a_missing_extra_is_named_with_the_line_that_installs_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "mcp.server.mcpserver", None)
    sentence = refusal("mcp", folder=tmp_path, run=in_process)
    assert "hexapods mcp needs a package" in sentence
    assert "racing-hexapods[mcp]" in sentence


def test_the_command_is_left_out_as_any_feature(tmp_path: Path) -> None:
    sentence = refusal("mcp", folder=tmp_path, run=in_process, HEXAPODS_WITHOUT="mcp")
    assert "mcp is a command of the feature mcp, which HEXAPODS_WITHOUT leaves out" in sentence
