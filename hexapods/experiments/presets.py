"""Presets of experiments: a sweep over axes, agents and seeds, with the values that each fixes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from hexapods.domain.errors import UnknownName
from hexapods.domain.observation import Observation
from hexapods.domain.robot import robot

Measure = Literal["distance", "blocks", "practice", "recovery"]
"""When learners are evaluated. `distance`: after their practice; `blocks`: after each block of it,
and once more in one go; `practice`: along it; `recovery`: after something happened to them."""

REACHED_SHARE = 0.95
"""Share of a reference's distance from which a walk counts as equally far."""
EARNING_STEPS = 50
"""Number of steps after each evaluation of a recovery whose rewards are added up."""
FIGURE4_BLOCKS = 8
GRID = ("steps", "steps_per_episode", "divisions", "grid_side_m")
"""Axes of a training beside agent, gait, observation, robot, world and the agents' settings."""


@dataclass(frozen=True, kw_only=True)
class Preset:
    """One experiment as data; fields that a preset does not take stay at their defaults.

    Attributes:
        name: name that users type and files contain.
        title: title on the page and in names of runs.
        heading: heading of its report; by default the title.
        description: description of its trials, for people who choose a preset.
        about: description in a few words; by default `description`.
        fields: fields of `ExperimentConfig` that users may set: axes, agents, seeds and others.
        defaults: values of its fields other than those of `ExperimentConfig`.
        ideal_defaults: defaults that differ in the kinematic simulator, which has no tolerance and
            few worlds.
        takes_settings: whether the settings of its agents are axes, too; the experiment is then
            named by its varied axes.
        measure: moments at which learners are evaluated.
        references: look-ahead agents that are always tried, in addition to its agents.
        reached_share: share of a reference's distance to which steps of practice are counted.
        is_timed: whether a race alone on the machine measures decision times in each scenario.
        is_published: whether the paper prints its numbers, with which they are compared.
        claims: claims of the paper that it judges, by their name in `claims.CLAIMS`.
        narrative: paragraphs of its report, by their name in `narrative.NARRATIVES`.
        names_best: whether its finding is the best of its combinations.
        command: arguments of `hexapods` that start it; by default `experiment NAME`.
    """

    name: str
    title: str
    description: str
    fields: tuple[str, ...]
    defaults: Mapping[str, Any] = field(default_factory=dict)
    ideal_defaults: Mapping[str, Any] = field(default_factory=dict)
    takes_settings: bool = False
    measure: Measure = "distance"
    references: tuple[str, ...] = ("greedy",)
    reached_share: float = REACHED_SHARE
    is_timed: bool = False
    is_published: bool = False
    claims: str | None = None
    narrative: str | None = None
    names_best: bool = False
    about: str = ""
    heading: str = ""
    command: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "heading", self.heading or self.title)
        object.__setattr__(self, "command", self.command or f"experiment {self.name}")

    @property
    def has_worlds(self) -> bool:
        """Whether the preset compares curves in worlds; all agents of a seed walk one robot."""
        return self.measure in ("practice", "recovery")

    @property
    def has_own_gaits(self) -> bool:
        """Whether each robot walks in the gait that suits it."""
        return self.defaults.get("gaits") == ()

    @property
    def earning_steps(self) -> int | None:
        """Number of steps after each evaluation whose rewards are added up; None where none are."""
        return EARNING_STEPS if self.measure == "recovery" else None

    @property
    def is_for_learners(self) -> bool:
        """Whether the preset compares learners only: other agents do not recover."""
        return self.measure == "recovery"


_MEASURED: tuple[Observation, ...] = ("measured",)
_COMMON_FIELDS = ("seeds", "seed", "gaits", "observations", "robots", "simulator")
_WORLD_FIELDS = ("agents", "worlds", "tolerance", "steps", "reward")
_LEARNERS = (
    "q-learning",
    "sarsa-lambda",
    "dyna-q",
    "r-max",
    "posterior-sampling",
    "linear-model",
)
_IN_WORLDS: Mapping[str, Any] = {
    "gaits": ("left-right-origin", "left-right-vertical"),
    "observations": _MEASURED,
    "tolerance": 0.03,
}

_ALL = (
    Preset(
        name="table1",
        title="Table 1",
        heading="Table 1 over many seeds",
        description="The paper’s Table 1: Q-learning after 500 and after 1000 steps beside greedy "
        "and two-step, in all four gaits, with the feet measured and with the commands remembered.",
        about="As in the paper, four gaits",
        fields=_COMMON_FIELDS,
        defaults={"steps": (500, 1000), "robots": (robot("stiff"), robot("compliant"))},
        references=("greedy", "two-step"),
        is_timed=True,
        is_published=True,
        claims="table1",
        narrative="table1",
    ),
    Preset(
        name="figure4",
        title="Figure 4",
        heading="Figure 4 over many seeds",
        description="The paper’s Figure 4: practice in blocks of 250 steps up to 2000, the table "
        "saved and loaded in between, beside as many steps in one go, and greedy as the line to "
        "reach.",
        about="Practice up to 2000 steps",
        fields=(*_COMMON_FIELDS, "agents"),
        defaults={"steps": (250,), "blocks": FIGURE4_BLOCKS},
        measure="blocks",
        claims="figure4",
        narrative="figure4",
    ),
    Preset(
        name="sweep",
        title="Sweep",
        heading="A sweep",
        description="A grid of any values: every combination is tried over all seeds. The paper "
        "names tuning as future work.",
        fields=(*_COMMON_FIELDS, "agents", *GRID, "reward"),
        defaults={"observations": _MEASURED},
        takes_settings=True,
        claims="sweep",
        narrative="sweep",
        names_best=True,
        command="sweep",
    ),
    Preset(
        name="league",
        title="League",
        heading="A league of learners and searchers",
        description="Learners and searchers in several worlds, with robots that differ a little by "
        "seed: distance against practice, beside greedy and the best known walk.",
        about="Learners and searchers in worlds",
        fields=(*_COMMON_FIELDS, *_WORLD_FIELDS),
        defaults={
            **_IN_WORLDS,
            "agents": (*_LEARNERS, "two-step", "informed"),
            "steps": (250,),
            "worlds": ("flat", "limp-pair", "slope", "ice"),
        },
        ideal_defaults={"tolerance": 0.0, "worlds": ("flat",)},
        measure="practice",
    ),
    Preset(
        name="recovery",
        title="Recovery",
        heading="Recovery after a disturbance",
        description="Learners practise, then something happens to them, and they learn on: how far "
        "they walk at once, and how soon they walk well again.",
        about="Learners that something happens to",
        fields=(*_COMMON_FIELDS, *_WORLD_FIELDS),
        defaults={
            **_IN_WORLDS,
            "agents": ("q-learning", "dyna-q", "linear-model"),
            "steps": (100,),
            "worlds": ("limp-pair", "stuck-leg"),
        },
        ideal_defaults={"tolerance": 0.0, "worlds": ("noise",)},
        measure="recovery",
        reached_share=0.9,
    ),
    Preset(
        name="groups",
        title="Fewer groups learn faster",
        description="Pairs of legs beside two groups of three: fewer groups have fewer states, 25 "
        "instead of 125, and Q-learning comes level with greedy after 250 steps.",
        about="Two groups of three legs, or three pairs",
        fields=(*_COMMON_FIELDS, *_WORLD_FIELDS),
        defaults={
            "gaits": ("left-right-origin", "left-right-vertical", "tripod"),
            "observations": _MEASURED,
            "steps": (250,),
            "steps_per_episode": (25,),
        },
        measure="practice",
        claims="groups",
    ),
    Preset(
        name="bodies",
        title="Bodies",
        heading="Learners on many bodies",
        description="Learners on robots with other bodies, each in the gait that suits it: how far "
        "they walk, and how soon.",
        about="Learners on creatures and kits",
        fields=(*(name for name in _COMMON_FIELDS if name != "gaits"), *_WORLD_FIELDS),
        defaults={
            "agents": ("q-learning", "linear-model"),
            "gaits": (),
            "observations": _MEASURED,
            "robots": tuple(
                robot(name)
                for name in ("stiff", "ant", "crab", "spider", "starfish", "dog", "centipede")
            ),
            "steps": (250,),
            "steps_per_episode": (25,),
        },
        measure="practice",
        reached_share=0.9,
    ),
)
PRESETS: dict[str, Preset] = {preset.name: preset for preset in _ALL}
"""All presets by name."""


def preset_of(name: str) -> Preset:
    """Return the preset of a name.

    Raises:
        UnknownName: if there is none.
    """
    if name not in PRESETS:
        raise UnknownName("experiment", name, PRESETS)
    return PRESETS[name]
