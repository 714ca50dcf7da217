"""Training loop (paper, Algorithm 1), and evaluation of the learned policy."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from hexapods.domain.disturbances import Disturbance, SensorNoise
from hexapods.domain.posture import has_fallen
from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action
from hexapods.domain.world import UNDISTURBED, World
from hexapods.runs.baseline import BASELINES, baseline_id
from hexapods.runs.best_known import best_known_m
from hexapods.runs.config import RACE_STEPS, TrainingConfig
from hexapods.runs.records import EpisodeEnded, Evaluated, Reference, StepTaken, TrainingRecord
from hexapods.runs.seeding import EVALUATION, generator
from hexapods.runs.transition_log import Logged, Transitions, transitions_of
from hexapods.runs.walker import Walker


@dataclass
class Learner:
    """Mutable state of a training. Between two records it may be saved, tuned or discarded.

    Attributes:
        walker: the robot that practises, with its agent.
        rng: the generator that the agent learns with.
        evaluator: makes a walker at rest, in a world, whose agent follows the learned policy and
            neither explores nor learns; its random numbers come from the given generator.
        baseline: makes the walker of the one-step look-ahead agent, which knows the world.
        step: number of steps that were learned.
        episode_reward_m: reward since the episode began.
        greedy_distance_m: distance of the baseline, once it was measured.
        measured_in: the world in which the baseline was measured.
        due_epsilon: ε of the newest step while its evaluation is yet to come; None if none is.
        next_action: the action that an on-policy agent has chosen to take next.
        next_epsilon: ε when that action was chosen.
        fell_at_step: the first step in which the robot fell, counted from 0; None if it did not.
        newest_epsilon: ε of the newest step.
        logged: steps that were logged since `take_transitions`; None where no log is kept.
    """

    walker: Walker
    rng: np.random.Generator
    evaluator: Callable[[World, np.random.Generator], Walker]
    baseline: Callable[[World], Walker]
    step: int = 0
    episode_reward_m: float = 0.0
    greedy_distance_m: float | None = None
    measured_in: World = UNDISTURBED
    due_epsilon: float | None = None
    next_action: Action | None = None
    next_epsilon: float = 0.0
    fell_at_step: int | None = None
    newest_epsilon: float = 0.0
    logged: list[Logged] | None = None

    @property
    def epsilon(self) -> float:
        """The probability of a random action at the next step; 0 for agents without one."""
        if self.next_action is not None:
            return self.next_epsilon
        return float(getattr(self.walker.agent, "epsilon", 0.0))

    @property
    def world(self) -> World:
        """All that happens in the training, including what was added while it ran."""
        return self.walker.simulator.world

    def conditions(self, steps: int) -> World:
        """Return the conditions of the next step, or of the last step once `steps` are done."""
        return self.world.as_of(min(self.step, steps - 1))

    def take_transitions(self) -> Transitions | None:
        """Return the steps logged since the last call; None if there are none."""
        if not self.logged:
            return None
        steps, self.logged = self.logged, []
        return transitions_of(self.step - len(steps), steps)

    def disturb(self, disturbance: Disturbance, config: TrainingConfig) -> Disturbance:
        """Add a disturbance from the next step on; an evaluation in the new world is due.

        Args:
            disturbance: the new one. Its `at_step` is replaced by the next step, of sensor noise
                by the one after: the feet were measured already.
            config: the training's config.

        Returns:
            the disturbance, with the step in which it begins.

        Raises:
            InvalidInput: if the disturbance cannot happen to this robot, contradicts the world, or
                the training has no more steps.
        """
        next_step = self.step + isinstance(disturbance, SensorNoise)
        started = replace(disturbance, at_step=next_step)
        world = self.world.then(started)
        world.check(config.robot, config.simulator, config.steps)
        self.walker.simulator.world = world
        if config.evaluate_every > 0 and next_step == self.step:
            self.due_epsilon = self.newest_epsilon
        return started


def train(
    learner: Learner, config: TrainingConfig, record: bool = False
) -> Iterator[TrainingRecord]:
    """Continue a training until `config.steps` steps are learned, and yield its records.

    The last record is an evaluation unless `config.evaluate_every` is 0, and there is one where
    conditions change. The reference is yielded before the first evaluation in each world.

    Args:
        learner: the training's state, which is updated.
        config: the training's config.
        record: whether steps and evaluations include their motion, and steps the action values.

    Raises:
        Diverged: if the physics diverges.
    """
    while True:
        yield from _evaluate_if_due(learner, config, record)
        if learner.step == config.steps:
            return
        epsilon, episode = learner.epsilon, learner.step // config.steps_per_episode
        learner.newest_epsilon = epsilon
        taken, earned_m = _practise(learner, episode, epsilon, record), learner.episode_reward_m
        has_ended = learner.step % config.steps_per_episode == 0 or learner.step == config.steps
        # Complete the state before the yield: the caller may checkpoint the learner there.
        learner.due_epsilon = epsilon if _is_due(learner, config) else None
        if has_ended:
            learner.episode_reward_m = 0.0
        yield taken
        if has_ended:
            yield EpisodeEnded(episode, learner.step, epsilon, earned_m)


def _evaluate_if_due(
    learner: Learner, config: TrainingConfig, record: bool
) -> Iterator[Reference | Evaluated]:
    while learner.due_epsilon is not None:
        conditions = learner.conditions(config.steps)
        if learner.greedy_distance_m is None or learner.measured_in != conditions:
            yield measure_baseline(learner, config, conditions)
        evaluated = evaluate(learner, config, learner.due_epsilon, record)
        if learner.conditions(config.steps) == conditions:  # nothing happened meanwhile
            learner.due_epsilon = None
            yield evaluated


def _practise(learner: Learner, episode: int, epsilon: float, record: bool) -> StepTaken:
    """Take one step: choose an action, carry it out, learn from the transition."""
    walker = learner.walker
    observation, action_values = walker.observed, walker.action_values() if record else None
    measured = walker.measured if learner.logged is not None else ()
    action = walker.decide() if learner.next_action is None else learner.next_action
    step = walker.carry_out(action, record)
    learner.next_action = None
    learner.next_epsilon = learner.epsilon  # before it learns, as an on-policy agent chooses then
    learner.next_action = walker.learn(observation, action, step.reward_m)
    if learner.logged is not None:
        after = walker.observed, walker.measured
        learner.logged.append(Logged(observation, measured, action, step.reward_m, *after))
    if learner.fell_at_step is None:
        torso, ground_m = walker.simulator.torso(walker.state), learner.world.ground_m(learner.step)
        if has_fallen(walker.simulator.robot, torso, ground_m):
            learner.fell_at_step = learner.step
    learner.step += 1
    learner.episode_reward_m += step.reward_m
    distance = walker.state.distance_m
    return StepTaken(
        learner.step,
        episode,
        epsilon,
        observation,
        action,
        step.reward_m,
        distance,
        step.motion,
        action_values,
    )


def measure_baseline(learner: Learner, config: TrainingConfig, conditions: World) -> Reference:
    """Run the baseline (one-step look-ahead) in a world, and store its distance in the learner.

    It walks only if its distance is not known in this process.
    """
    baseline = baseline_id(config, conditions)
    distance_m = BASELINES.get(baseline)
    if distance_m is None:
        distance_m, _ = walk(learner.baseline(conditions), record=False)
        BASELINES.add({baseline: distance_m})
    learner.greedy_distance_m, learner.measured_in = distance_m, conditions
    return Reference(distance_m, best_known_m(config, conditions), baseline)


def evaluate(
    learner: Learner, config: TrainingConfig, epsilon: float, record: bool = False
) -> Evaluated:
    """Evaluate the policy learned so far: 50 steps from rest at ε = 0; the learner is unchanged.

    It walks in the world as it is, which does not change meanwhile. The random generator is derived
    from seed and step, so a result does not depend on the number of earlier evaluations.

    Args:
        learner: the training's state.
        config: the training's config.
        epsilon: ε of the practice, for the record.
        record: whether to include the motion.
    """
    rng = generator(config.seed, EVALUATION, learner.step)
    evaluator = learner.evaluator(learner.conditions(config.steps), rng)
    distance, motion = walk(evaluator, record)
    return Evaluated(learner.step, epsilon, distance, motion)


def walk(walker: Walker, record: bool) -> tuple[float, Motion | None]:
    """Take 50 steps; return the distance [m], and the motion if `record` is set, else None."""
    motions: list[Motion] = []
    for number in range(RACE_STEPS):
        step = walker.carry_out(walker.decide(), record)
        if step.motion:
            start = number * walker.simulator.robot.step_s
            motions.append(step.motion._replace(time_s=step.motion.time_s + np.float32(start)))
    distance: float = walker.state.distance_m
    return distance, _concatenate(motions) if motions else None


def _concatenate(motions: list[Motion]) -> Motion:
    return Motion(
        np.concatenate([motion.time_s for motion in motions]),
        np.concatenate([motion.qpos for motion in motions]),
    )


def _is_due(learner: Learner, config: TrainingConfig) -> bool:
    step, every, world = learner.step, config.evaluate_every, learner.world
    is_change = step in world.change_steps and step < config.steps
    return every > 0 and (step % every == 0 or step == config.steps or is_change)
