"""In how many races the learner is ahead of greedy at the finish, over seeds and gaits, on MuJoCo.

    python benchmarks/learner_against_greedy.py --seeds 30 --steps 500 1000

Paper clock; the learner reads its state `measured`. Prints a line for each gait and practice, and
the whole as JSON at the end. Deterministic: the same seeds give the same counts.
"""

import argparse
import json
import time
from multiprocessing import get_context

from app.assembly import build_learner, build_walkers
from app.domain.gait import NAMED_GAITS
from app.runs.config import LaneConfig, RaceConfig, TrainingConfig
from app.runs.racing import record_race
from app.runs.results import race_result
from app.runs.tables import snapshot
from app.runs.training import train

Trial = tuple[str, int, int]


def is_ahead(trial: Trial) -> bool:
    """Train with this gait, practice and seed; race greedy; who is farther at the finish?"""
    gait, steps, seed = trial
    config = TrainingConfig(gait=gait, steps=steps, seed=seed, evaluate_every=0)
    learner = build_learner(config)
    for _ in train(learner, config):
        pass
    lanes = (LaneConfig(agent="q-learning"), LaneConfig(agent="greedy"))
    race = RaceConfig(gait=gait, lanes=lanes, seed=seed)
    walkers = build_walkers(race, [snapshot(learner, config), None], threads=1)
    *_, recording = record_race(walkers, race, time.perf_counter)
    result = race_result(recording, race.steps)
    learned, greedy = (lane["clocks"]["paper"]["finished_distance_m"] for lane in result["lanes"])
    return bool(learned > greedy)


def main() -> None:
    """Run every trial on all cores."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--steps", type=int, nargs="+", default=[500, 1000])
    options = parser.parse_args()
    counts: dict[str, dict[str, int]] = {}
    with get_context("spawn").Pool() as pool:
        for steps in options.steps:
            counts[str(steps)] = {}
            for gait in NAMED_GAITS:
                trials = [(gait, steps, seed) for seed in range(options.seeds)]
                counts[str(steps)][gait] = sum(pool.map(is_ahead, trials, chunksize=1))
                print(f"{gait}, {steps} steps: ahead in {counts[str(steps)][gait]}", flush=True)
    for ahead in counts.values():
        ahead["all"] = sum(ahead.values())
    print(json.dumps({"seeds": options.seeds, "ahead": counts}))


if __name__ == "__main__":
    main()
