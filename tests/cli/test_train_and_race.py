"""`hexapods train` and `hexapods race`, as a user runs them."""

import json
import shutil
from dataclasses import asdict
from pathlib import Path

import pytest

import hexapods as hx
from app.cli.exit_codes import FAILED
from hexapods.assembly import build_learner
from hexapods.runs.best_known import best_known_m
from hexapods.runs.config import WalkingProblem, training_config
from hexapods.runs.results import training_result
from hexapods.runs.training import train
from tests.cli.running import EXAMPLES, hexapods, in_process, output, refusal
from tests.quick_robot import HASTY, QUICK_STEPS

GAIT = ("--gait", "left-right-origin")
QUICK = (*GAIT, "--simulator", "kinematic")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a trained Q-table, `q.npz`, and what the training printed, `said`."""
    place = tmp_path_factory.mktemp("cli")
    done = hexapods("train", *QUICK, "--steps", "300", "--out", "q.npz", folder=place)
    assert done.returncode == 0, done.stderr
    (place / "said").write_text(done.stdout)
    return place


def test_train_prints_the_distance(folder: Path) -> None:
    assert "After 300 steps of practice it walks 0." in (folder / "said").read_text()
    assert (folder / "q.npz").stat().st_size > 1000


def test_train_equals_a_direct_call(tmp_path: Path) -> None:
    lines = [f"{name} = {value}" for name, value in QUICK_STEPS.items()]
    (tmp_path / "quick.toml").write_text("\n".join(lines))
    options = ("--robot", "quick.toml", "--steps", "60", "--seed", "7")
    printed = output("train", *GAIT, *options, folder=tmp_path)
    config = training_config(gait="left-right-origin", robot=HASTY, steps=60, seed=7)
    learner = build_learner(config)
    for _ in train(learner, config):
        pass
    assert printed["result"] == asdict(training_result(learner, config))
    assert [point["step"] for point in printed["curve"]] == [50, 60]


def test_a_race_equals_a_direct_call(tmp_path: Path) -> None:
    lanes = ("--lane", "greedy", "--lane", "random-walk")
    printed = output("race", *QUICK, *lanes, "--seed", "3", folder=tmp_path, run=in_process)
    config = printed["config"]
    problem = {"gait": config["gait"], "simulator": config["simulator"], "steps": config["steps"]}
    race = hx.race(["greedy", "random-walk"], seed=3, **problem)
    assert printed["recording_sha256"] == race.recording_sha256


def test_train_and_race_print_the_best_known_distance_where_it_is_known(
    folder: Path, tmp_path: Path
) -> None:
    best_m = best_known_m(WalkingProblem(gait="left-right-origin"))
    assert best_m is not None
    train = ("train", *GAIT, "--steps", "5", "--evaluate-every", "0")
    race = ("race", *GAIT, "--lane", "wave", "--world", "flat")

    assert output(*race, folder=tmp_path, run=in_process)["best_known_m"] == best_m
    shown = in_process(*race, folder=tmp_path).stdout
    assert shown.endswith(f"Best known, total: {best_m:.2f} m\n")
    shown = in_process(*train, folder=tmp_path).stdout
    assert shown.endswith(f" m, the best known walk is {best_m:.2f} m.\n")

    assert " best known " not in (folder / "said").read_text(), "it is computed in MuJoCo"
    unknown = ("race", *QUICK, "--lane", "wave")
    assert output(*unknown, folder=tmp_path, run=in_process)["best_known_m"] is None
    assert "Best known" not in in_process(*unknown, folder=tmp_path).stdout


def test_training_continues_from_a_table(folder: Path) -> None:
    result = output(
        "train", *QUICK, "--steps", "300", "--from", "q.npz", "--out", "q2.npz", folder=folder
    )
    assert result["config"]["seed"] == 0
    assert (folder / "q2.npz").read_bytes() != (folder / "q.npz").read_bytes()


def test_race_of_a_table_against_look_ahead(folder: Path) -> None:
    race = ("race", *QUICK, "--lane", "q-learning=q.npz", "--lane", "greedy", "--lane", "two-step")
    lanes = output(*race, folder=folder)["result"]["lanes"]
    assert [lane["agent"] for lane in lanes] == ["q-learning", "greedy", "two-step"]
    assert [lane["simulated_transitions"] for lane in lanes] == [0, 600, 7800]
    assert lanes[1]["total_distance_m"] == pytest.approx(24.833 * 0.02, abs=1e-4)
    shown = hexapods(*race, "--clock", "free", folder=folder)
    assert "Ranked at time-out, no clock" in shown.stdout


def test_a_race_prints_the_gait_of_each_lane(tmp_path: Path) -> None:
    ripple = json.dumps({"right_leg": 1, "left_leg": 2, "pairs": [[1, 4], [5, 3], [6, 2]]})
    lanes = ("--lane", "wave", "--lane", "wave,direction=retrograde", "--lane", "random-walk")
    race = ("race", "--gait", ripple, *lanes, "--steps", "20")
    wave, retrograde, wandering = output(*race, folder=tmp_path, run=in_process)["gait"]

    assert wave["cycle"]["steps"] == retrograde["cycle"]["steps"] == 3
    assert wandering["cycle"] is None
    for summary in (wave, retrograde):
        assert summary["speed_m_s"] > 0.02
        assert summary["cost_of_transport"] < 5
        assert len(summary["leg_duty_factors"]) == 6


def test_a_race_in_which_all_fail_has_no_ranking(tmp_path: Path) -> None:
    clumsy = ("--lane", "tests.own_agents:Clumsy")
    done = in_process("race", *QUICK, *clumsy, *clumsy, folder=tmp_path)
    assert done.returncode == FAILED, done.stderr
    assert "No ranking: no lane used all its steps" in done.stdout
    assert done.stdout.count("tripped") == 2
    assert "None" not in done.stdout


def test_lanes_take_settings_and_keep_learning(folder: Path) -> None:
    lanes = (
        "look-ahead,depth=2",
        "q-learning=q.npz,keep_learning=true",
        "q-learning,keep_learning=true,alpha=0.5,observation=planned",
    )
    race = ("race", *QUICK, "--steps", "5", *(word for lane in lanes for word in ("--lane", lane)))
    printed = output(*race, folder=folder)
    settings = [
        (lane["settings"].get("depth"), lane["keep_learning"], lane["settings"].get("alpha"))
        for lane in printed["config"]["lanes"]
    ]
    assert settings == [(2, False, None), (None, True, None), (None, True, 0.5)]
    seen = [lane["observation"] for lane in printed["config"]["lanes"]]
    assert seen == ["measured", "measured", "planned"]
    assert printed["result"]["lanes"][0]["simulated_transitions"] == 5 * 156
    shown = hexapods(*race, folder=folder).stdout.replace("\u00a0", " ")
    assert "Look-ahead, depth 2" in shown
    assert "plans with the true model" in shown
    assert "Q-learning, α 0.5, keeps learning" in shown


def test_the_example_agent_learns_and_races(tmp_path: Path) -> None:
    example = EXAMPLES / "my_agent.py"
    assert len(example.read_text("utf-8").splitlines()) <= 40
    shutil.copy(example, tmp_path)
    mine = ("--agent", "my_agent:Agent", "--steps", "100", "--out", "mine.npz")
    trained = output("train", *GAIT, *mine, folder=tmp_path)["result"]
    assert trained["distance_m"] > 0.9 * trained["greedy_distance_m"]
    lanes = ("--lane", "my_agent:Agent=mine.npz", "--lane", "greedy", "--steps", "10")
    raced = output("race", *GAIT, *lanes, folder=tmp_path)["result"]["lanes"]
    assert raced[0]["clocks"]["paper"]["rank"] == 1
    assert raced[0]["failure"] is None


def test_custom_robot_and_gait_are_accepted(tmp_path: Path) -> None:
    (tmp_path / "eight.toml").write_text('preset = "compliant"\nn_legs = 8\nhome_radius_m = 0.26\n')
    gait = json.dumps({"right_leg": 1, "left_leg": 2, "pairs": [[1, 2], [8, 3], [7, 4], [6, 5]]})
    options = ("--gait", gait, "--robot", "eight.toml", "--steps", "20", "--evaluate-every", "0")
    config = output("train", *options, folder=tmp_path)["config"]
    assert config["robot"]["preset"] == "compliant"
    assert len(config["robot"]["legs"]) == 8
    assert config["gait"]["pairs"][1] == [8, 3]


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (("--gait", "moonwalk"), "left-right-origin, left-right-vertical"),
        (("--gait", '{"right_leg": 1}'), "right_leg and left_leg"),
        (("--gait", "{"), "not valid JSON"),
        (("--gait", '{"groups": ' + "[" * 20_000), "nested too deeply"),
        ((*GAIT, "--robot", "deep.toml"), "nested too deeply"),
        ((*GAIT, "--steps", "0"), "from 1 to 10,000,000"),
        ((*GAIT, "--steps", "-1"), "from 1 to 10,000,000"),
        ((*GAIT, "--steps", "1e12"), "a whole number"),
        ((*GAIT, "--steps", "1000000000000"), "from 1 to 10,000,000"),
        ((*GAIT, "--steps", "nan"), "a whole number"),
        ((*GAIT, "--alpha", "nan"), "over 0 and at most 1"),
        ((*GAIT, "--seed", "-1"), "at least 0"),
        ((*GAIT, "--divisions", "9"), "from 2 to 8"),
        ((*GAIT, "--grid-side-m", "0.2"), "leg 2 cannot reach cell 1 (front left)"),
        ((*GAIT, "--grid-side-m", "0.001"), "from 0.005 to 10"),
        ((*GAIT, "--robot", "sloth"), "stiff, compliant, slippery"),
        ((*GAIT, "--robot", '{"wings": 2}'), "femur_m"),
        ((*GAIT, "--robot", '{"femur_m": -1}'), "robot.femur_m must be from"),
        ((*GAIT, "--robot", '{"n_legs": 13}'), "3 to 12 legs"),
        ((*GAIT, "--robot", "missing.toml"), "missing.toml"),
        ((*GAIT, "--simulator", "matrix"), '"mujoco", "kinematic"'),
        ((*GAIT, "--observation", "guessed"), '"measured", "commanded", "planned"'),
        (
            (*GAIT, "--agent", "skynet"),
            "linear-model, tamer, greedy, two-step, look-ahead, ",
        ),
        ((*GAIT, "--agent", "no_module:Agent"), "cannot import no_module"),
        ((*GAIT, "--from", "missing.npz"), "missing.npz"),
        ((*GAIT, "--out", "no/such/folder/q.npz"), "choose a folder that can be written"),
    ],
)
def test_invalid_input_to_train_is_refused_in_one_sentence(
    arguments: tuple[str, ...], names: str, tmp_path: Path
) -> None:
    (tmp_path / "deep.toml").write_text("legs = " + "[" * 20_000)
    assert names in refusal("train", *arguments, folder=tmp_path, run=in_process)


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        ((*QUICK, "--lane", "q-learning"), "q-learning=q.npz"),
        ((*QUICK, "--lane", "greedy=q.npz"), "learned by q-learning"),
        (("--gait", "front-back-origin", "--lane", "q-learning=q.npz"), "gait left-right-origin"),
        ((*QUICK, "--divisions", "3", "--lane", "q-learning=q.npz"), "divisions 2"),
        ((*QUICK, *(["--lane", "greedy"] * 7)), "1 to 6 lanes"),
        ((*QUICK, "--lane", "greedy", "--clock", "cuckoo"), '"paper", "wall", "free"'),
        ((*QUICK, "--lane", "look-ahead,depth=0"), "depth must be a whole number from 1 to 50"),
        *(
            (
                (*QUICK, "--lane", f"{agent},budget=0"),
                "budget must be a whole number from 1 to 40,000, not 0",
            )
            for agent in ("informed", "mcts")
        ),
        ((*QUICK, "--lane", "look-ahead,depth=deep"), "depth must be a whole number from 1 to 50"),
        ((*QUICK, "--lane", "look-ahead,depth=5"), "choose depth 4 or less"),
        (
            (*QUICK, "--lane", "greedy,depth=2"),
            "choose one of: observation, keep_learning, plans_with",
        ),
        ((*QUICK, "--lane", "greedy,agent=beam"), "unknown setting of a greedy lane 'agent'"),
        ((*QUICK, "--lane", "greedy,keep_learning=true"), "greedy does not learn"),
        ((*QUICK, "--lane", "q-learning=q.npz,alpha=0.5"), "leave out alpha"),
        (
            (*QUICK, "--lane", "q-learning=q.npz,observation=planned"),
            "observation must be measured, in which its training was learned, not planned",
        ),
        (
            (*QUICK, "--lane", "greedy,observation=guessed"),
            "observation must be measured, or commanded, or planned, not 'guessed'",
        ),
        ((*QUICK,), "--lane"),
    ],
)
def test_invalid_input_to_race_is_refused_in_one_sentence(
    arguments: tuple[str, ...], names: str, folder: Path
) -> None:
    assert names in refusal("race", *arguments, folder=folder, run=in_process)


def test_seed_with_a_table_to_continue_is_refused(folder: Path) -> None:
    sentence = refusal(
        "train", *QUICK, "--from", "q.npz", "--seed", "1", folder=folder, run=in_process
    )
    assert "leave --seed out" in sentence


def test_file_that_is_no_table_is_refused_by_name(folder: Path) -> None:
    (folder / "shopping.npz").write_text("milk")
    sentence = refusal("race", *QUICK, "--lane", "q-learning=shopping.npz", folder=folder)
    assert "shopping.npz is not a Q-table" in sentence


def test_worlds_and_disturbances_are_options(tmp_path: Path) -> None:
    options = ("--world", "slope", "--disturb", "limp:legs=1,4:at=2", "--steps", "4")
    printed = output("race", *GAIT, *options, "--lane", "greedy", folder=tmp_path)

    assert [disturbance["kind"] for disturbance in printed["config"]["disturbances"]] == [
        "slope",
        "limp",
    ]
    assert printed["result"]["lanes"][0]["fell_at_step"] is None
    assert abs(printed["result"]["lanes"][0]["heading_deg"]) < 45
    assert printed["config"]["lanes"][0]["plans_with"] is None  # as it was given
    assert printed["result"]["lanes"][0]["plans_with"] == "start"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--world", "moon"), "choose one of: flat, slope"),
        (("--disturb", "limp:legs=7"), "there is no leg 7"),
        (("--disturb", "limp:legs=1:at=500"), "at_step must be from 0 to 499"),
        (("--disturb", "limp:legs=1:until=501"), "until_step must be at most 500, the end"),
        (("--disturb", "limp:legs=1:at=9:until=3"), "until_step must be over at_step, 9"),
        (("--disturb", "limp"), "limp needs legs"),
        (("--world", "slope", "--disturb", "slope:degrees=3"), "contradict each other"),
        (("--world", "slope", "--simulator", "kinematic"), "knows no slope"),
    ],
)
def test_impossible_worlds_are_refused(
    tmp_path: Path, options: tuple[str, ...], words: str
) -> None:
    assert words in refusal("train", *GAIT, *options, folder=tmp_path, run=in_process)
