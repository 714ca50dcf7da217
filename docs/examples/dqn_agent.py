"""A deep Q-network joins the race: Stable-Baselines3 trains it on the Gymnasium environment.

    python dqn_agent.py --gait left-right-origin --steps 1000 --out dqn.npz
    hexapods race --gait left-right-origin --lane dqn_agent:Agent=dqn.npz --lane greedy

Only the first line needs `racing-hexapods[dqn]`; in the race the network is three matrices.

Measured on MuJoCo with `--seed 0` to `--seed 19`: its distance after 1,000 steps of practice, as a
share of greedy's.

    gait                   median  worst  best
    left-right-origin       1.00   0.99  1.00
    left-right-vertical     1.03   0.93  1.05
    front-back-origin       1.00   1.00  1.00
    front-back-vertical     1.00   0.99  1.00

Q-learning with a table comes to about 0.83 after as many steps. The network sees no more of the
robot, but learns from each step about seven times, and can carry what a move of one pair earns over
to states that it never saw.
"""

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hexapods.agents.protocol import AgentState, Problem, Transition
from hexapods.assembly import build_learner
from hexapods.domain.types import Action, Cells
from hexapods.runs.config import training_config
from hexapods.runs.results import training_result
from hexapods.runs.tables import snapshot, to_bytes


class Agent:
    """Takes the legal action that the network values most. It learns beforehand, not here."""

    def __init__(self, problem: Problem) -> None:
        self.shape = len(problem.groups), len(problem.cells_m)
        self.layers: list[tuple[NDArray[Any], NDArray[Any]]] = []  # of each its weights and biases

    def act(self, observation: Cells, legal: Sequence[Action]) -> Action:
        signal = np.eye(self.shape[1])[list(observation)].ravel()  # the cell of each pair, one-hot
        for number, (weights, biases) in enumerate(self.layers):
            signal = weights @ (np.maximum(signal, 0) if number else signal) + biases
        values = signal.reshape(self.shape)
        return max(legal, key=lambda action: values[action.group, action.cell])

    def learn(self, transition: Transition) -> None:
        pass

    def state(self) -> AgentState:
        arrays: AgentState = {}
        for number, (weights, biases) in enumerate(self.layers):
            arrays |= {f"weights{number}": weights.copy(), f"biases{number}": biases.copy()}
        return arrays

    def load(self, state: AgentState) -> None:
        numbers = range(len(state) // 2)
        self.layers = [(state[f"weights{number}"], state[f"biases{number}"]) for number in numbers]


def practise(walk: Mapping[str, Any], steps: int, seed: int) -> AgentState:
    """Train a network on `RacingHexapods/Walk-v0`; what `Agent.load` takes."""
    import gymnasium
    import torch
    from stable_baselines3 import DQN

    torch.set_num_threads(1)  # is quicker with a network so small
    environment: Any = gymnasium.make("hexapods.environment:RacingHexapods/Walk-v0", **walk)
    # In centimetres, because a network learns badly from rewards of a hundredth.
    environment = gymnasium.wrappers.TransformReward(
        environment, lambda reward_m: 100 * float(reward_m)
    )
    dqn = DQN(
        "MlpPolicy",
        environment,
        gamma=0.9,
        learning_rate=0.001,
        learning_starts=100,
        target_update_interval=200,
        exploration_fraction=0.5,
        seed=seed,
        device="cpu",
    ).learn(steps)
    layers = [layer for layer in dqn.q_net.q_net if isinstance(layer, torch.nn.Linear)]
    arrays: AgentState = {}
    for number, layer in enumerate(layers):
        arrays[f"weights{number}"] = layer.weight.detach().numpy().astype(float)
        arrays[f"biases{number}"] = layer.bias.detach().numpy().astype(float)
    return arrays


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--gait", default="left-right-origin")
    parser.add_argument("--simulator", default="mujoco")
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("dqn.npz"))
    options = parser.parse_args()

    walk: dict[str, Any] = {"gait": options.gait, "simulator": options.simulator}
    config = training_config(
        **walk, steps=options.steps, seed=options.seed, agent="dqn_agent:Agent", evaluate_every=0
    )
    learner = build_learner(config)
    learner.walker.agent.load(practise(walk, options.steps, options.seed))
    learner.step = options.steps
    result = training_result(learner, config)
    options.out.write_bytes(to_bytes(snapshot(learner, config)))
    print(
        f"After {options.steps:,} steps it walks {result.distance_m:.2f} m, "
        f"greedy {result.greedy_distance_m:.2f} m. The network is in {options.out}."
    )


if __name__ == "__main__":
    main()
