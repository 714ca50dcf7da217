"""DQN and PPO of Stable-Baselines3 as agents that learn while they walk, without resets.

    hexapods train --gait left-right-origin --agent sb3_agents:Dqn --steps 500 --out dqn.npz
    hexapods benchmark sb3_agents:Ppo

They need `racing-hexapods[dqn]` to learn; a frozen copy is a few matrices. Observations and actions
are those of `RacingHexapods/Walk-v0`: each group's cell, one-hot, and a group with its new cell. As
there, an action that is not legal does nothing and earns nothing, but is one of the steps for
which the algorithm practises; the robot walks fewer. Unlike there no episode ends: the robot is
never put back. A practice that was stopped cannot be resumed: what is loaded walks as it is.

The algorithm runs its own loop, in a thread, on an environment whose robot is this agent's. Only
one of the two threads runs at any time, so that the same seed gives the same result.
"""

import queue
import threading
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import hexapods as hx

REWARD_SCALE = 100.0
"""In centimetres, because a network learns badly from rewards of a hundredth."""


class Sb3Agent:
    """Base class: hands actions and transitions to and fro; a subclass makes the algorithm."""

    needs_practice = True

    def __init__(
        self, rng: np.random.Generator, problem: hx.Problem, explore: bool = True, steps: int = 500
    ) -> None:
        self.shape = len(problem.groups), len(problem.cells_m)
        self.seed, self.explore, self.steps = int(rng.integers(2**31)), explore, steps
        self.layers: list[tuple[NDArray[Any], NDArray[Any]]] = []
        self.wanted: hx.Action | None = None
        self.practice: _Practice | None = None

    def act(self, observation: tuple[int, ...], legal: Sequence[hx.Action]) -> hx.Action:
        if self.explore and not self.layers:
            if self.practice is None:
                self.practice = _Practice(self, observation, legal)
                self.wanted = self.practice.wanted()
            if self.wanted is not None:
                return self.wanted
        return self.best(observation, legal)

    def learn(self, transition: hx.Transition) -> None:
        if self.practice is not None and self.wanted is not None:
            self.practice.answer(transition)
            self.wanted = self.practice.wanted()  # here, so that what it learns is in the state

    def best(self, observation: tuple[int, ...], legal: Sequence[hx.Action]) -> hx.Action:
        """Return the legal action that the network prefers."""
        layers = self.layers or self.practised()
        signal = np.eye(self.shape[1])[list(observation)].ravel()
        for number, (weights, biases) in enumerate(layers):
            signal = weights @ (self.activate(signal) if number else signal) + biases
        values = signal.reshape(self.shape)
        return max(legal, key=lambda action: values[action.group, action.cell])

    def practised(self) -> list[tuple[NDArray[Any], NDArray[Any]]]:
        """Return weights and biases of the network as they are now."""
        if self.practice is None:
            count = self.shape[0] * self.shape[1]
            return [(np.zeros((count, count)), np.zeros(count))]
        layers = self.network(self.practice.algorithm)
        return [
            (layer.weight.detach().numpy().astype(float), layer.bias.detach().numpy().astype(float))
            for layer in layers
        ]

    def state(self) -> hx.AgentState:
        arrays: hx.AgentState = {}
        for number, (weights, biases) in enumerate(self.layers or self.practised()):
            arrays |= {f"weights{number}": weights.copy(), f"biases{number}": biases.copy()}
        return arrays

    def load(self, state: hx.AgentState) -> None:
        numbers = range(len(state) // 2)
        self.layers = [(state[f"weights{number}"], state[f"biases{number}"]) for number in numbers]

    def algorithm(self, environment: Any) -> Any:
        """Return the algorithm of Stable-Baselines3."""
        raise NotImplementedError

    def network(self, algorithm: Any) -> list[Any]:
        """Return the linear layers from the observation to a number for each action."""
        raise NotImplementedError

    def activate(self, signal: NDArray[Any]) -> NDArray[Any]:
        """Apply the activation function between two layers."""
        raise NotImplementedError


class Dqn(Sb3Agent):
    """Deep Q-network (Mnih et al. 2015), with the settings of `dqn_agent.py`."""

    title = "DQN"
    description = "Stable-Baselines3: learns the value of each action with a network."

    def algorithm(self, environment: Any) -> Any:
        from stable_baselines3 import DQN

        return DQN(
            "MlpPolicy",
            environment,
            gamma=0.9,
            learning_rate=0.001,
            learning_starts=min(100, self.steps // 5),
            target_update_interval=200,
            exploration_fraction=0.5,
            seed=self.seed,
            device="cpu",
        )

    def network(self, algorithm: Any) -> list[Any]:
        return [layer for layer in algorithm.q_net.q_net if hasattr(layer, "weight")]

    def activate(self, signal: NDArray[Any]) -> NDArray[Any]:
        return np.asarray(np.maximum(signal, 0))


class Ppo(Sb3Agent):
    """Proximal policy optimisation (Schulman et al. 2017), with batches for a short practice."""

    title = "PPO"
    description = "Stable-Baselines3: improves the policy itself, in small steps."

    def algorithm(self, environment: Any) -> Any:
        from stable_baselines3 import PPO

        return PPO(
            "MlpPolicy",
            environment,
            gamma=0.9,
            learning_rate=0.001,
            n_steps=50,
            batch_size=25,
            seed=self.seed,
            device="cpu",
        )

    def network(self, algorithm: Any) -> list[Any]:
        layers = [*algorithm.policy.mlp_extractor.policy_net, algorithm.policy.action_net]
        return [layer for layer in layers if hasattr(layer, "weight")]

    def activate(self, signal: NDArray[Any]) -> NDArray[Any]:
        return np.asarray(np.tanh(signal))


class _Practice:
    """The algorithm's loop in a thread, and what it exchanges with the agent."""

    def __init__(
        self, agent: Sb3Agent, observation: tuple[int, ...], legal: Sequence[hx.Action]
    ) -> None:
        import gymnasium
        import torch

        torch.set_num_threads(1)  # is quicker with a network so small
        actions: queue.SimpleQueue[hx.Action | BaseException | None] = queue.SimpleQueue()
        answers: queue.SimpleQueue[hx.Transition] = queue.SimpleQueue()
        groups, cells = agent.shape

        class Robot(gymnasium.Env[NDArray[np.int64], np.int64]):
            """The agent's robot, as the algorithm sees it."""

            observation_space = gymnasium.spaces.MultiDiscrete([cells] * groups)
            action_space = gymnasium.spaces.Discrete(groups * cells)

            def __init__(self) -> None:
                self.cells, self.legal = observation, legal

            def reset(self, **_: Any) -> tuple[NDArray[np.int64], dict[str, Any]]:
                return np.array(self.cells), {}

            def step(
                self, action: np.int64
            ) -> tuple[NDArray[np.int64], float, bool, bool, dict[str, Any]]:
                wanted, reward = hx.Action(*divmod(int(action), cells)), 0.0
                if wanted in self.legal:
                    actions.put(wanted)
                    answer = answers.get()
                    self.cells, self.legal = answer.next_observation, answer.next_legal
                    reward = REWARD_SCALE * answer.reward_m
                return np.array(self.cells), reward, False, False, {}

        def practise() -> None:
            try:
                self.algorithm.learn(agent.steps)
            except BaseException as error:
                actions.put(error)
            else:
                actions.put(None)

        self._actions, self.answer = actions, answers.put
        self.algorithm = agent.algorithm(Robot())
        threading.Thread(target=practise, daemon=True).start()

    def wanted(self) -> hx.Action | None:
        """Wait for the next action that the algorithm wants; None when it has practised enough.

        Raises:
            Exception: that of the algorithm, if it failed.
        """
        action = self._actions.get()
        if isinstance(action, BaseException):
            raise action
        return action
