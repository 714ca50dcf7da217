"""Sentences and titles of the options that are no declared settings."""

from hexapods.runs import best_known

EXPERIMENT_TEXTS = {
    "table1": (
        "The paper’s Table 1: Q-learning after 500 and after 1000 steps beside greedy and "
        "two-step, in all four gaits, with the feet measured and with the commands remembered."
    ),
    "figure4": (
        "The paper’s Figure 4: practice in blocks of 250 steps up to 2000, the table saved and "
        "loaded in between, beside as many steps in one go, and greedy as the line to reach."
    ),
    "sweep": (
        "A grid of any values: every combination is tried over all seeds. The paper names tuning "
        "as future work."
    ),
    "league": (
        "Learners and searchers in several worlds, with robots that differ a little by seed: "
        "distance against practice, beside greedy and the best known walk."
    ),
    "recovery": (
        "Learners practise, then something happens to them, and they learn on: how far they walk "
        "at once, and how soon they walk well again."
    ),
    "groups": (
        "Pairs of legs beside two groups of three: fewer groups have fewer states, 25 instead of "
        "125, and Q-learning comes level with greedy after 250 steps."
    ),
    "bodies": (
        "Learners on robots with other bodies, each in the gait that suits it: how far they walk, "
        "and how soon."
    ),
}
GAIT_TEXTS = {
    "left-right-origin": (
        "Three legs on each side of the way; legs that stand opposite each other move together."
    ),
    "left-right-vertical": (
        "Three legs on each side of the way; each leg moves with its mirror image."
    ),
    "front-back-origin": (
        "One leg leads, three in front and three behind; opposite legs move together."
    ),
    "front-back-vertical": (
        "One leg leads, three in front and three behind; each leg moves with its mirror image."
    ),
    "tripod": "Six legs: three of them move together, three stand, as most insects run.",
    "tetrapod": "Four legs stand, while two or four others move together.",
    "trot": "Every other leg around the body moves: of four legs those on a diagonal.",
    "pace": "All legs of one side move together; most bodies tip.",
    "bound": "The legs in front move together, then all others; most bodies tip.",
    "one-by-one": "Each leg moves alone, while all others stand: steady, but many states.",
}
OBSERVATION_TEXTS = {
    "measured": "Where the feet are, by the joint angles.",
    "commanded": "Where the feet were last sent; the body's drift is not seen.",
    "planned": "Where the feet would be if nothing had slipped, reckoned from the commands.",
}
CLOCK_TEXTS = {
    "paper": "A decision costs a share of a step's time for every future that was simulated.",
    "wall": "A decision costs the time that this computer took for it.",
    "free": "Thinking costs nothing.",
}
SIMULATOR_TEXTS = {
    "mujoco": "Real physics: servos, contacts, friction.",
    "kinematic": "The law of a step without slip: exact, and very quick.",
}
SIMULATOR_TITLES = {"mujoco": "MuJoCo physics", "kinematic": "ideal (no slip)"}
FIELD_HELP = {
    "gait": "Which way is forward, and which legs move together.",
    "observation": "How the robot knows where its feet are.",
    "robot": "Which robot walks; it differs in servos and friction.",
    "simulator": "What computes the walking.",
    "lanes": "Which agents race.",
    "legs": "How many legs a robot may have.",
    "disturbances": "Changes of the robot or the ground, each from a step on.",
    "clock": "What thinking costs in the race; it can change who wins.",
    "name": "What the run is called in the list.",
    "tag": "A word by which the list of runs is filtered.",
    "tags": "How many words a run may have by which the list is filtered.",
    "notes": "What is worth remembering about a run.",
    "import_bytes": "How large a file may be that is imported.",
    "run_ids": "How many runs a request may name.",
    "best_known": best_known.DEFINITION,
    "best_known_where": best_known.COVERAGE,
    "gait_window_s": "How much of a walk is analysed at once, in seconds of robot time.",
    "agent": "Which agent learns.",
    "seeds": "How often each setting is tried, each time with other random numbers.",
    "gaits": "Which gaits are tried.",
    "robots": "Which robots are tried.",
    "observations": "Which observations are tried.",
    "worlds": "Which worlds are tried.",
    "agents": "Which agents learn or search, and are compared with each other.",
    "settings": "Combinations of values; each is tried over all seeds.",
    "trials": "Settings times seeds; agents that look ahead are tried once.",
    "workers": "How many trials are computed at once; by default one for each core.",
}
FIELD_TITLES = {
    "gait": "Gait",
    "gaits": "Gaits",
    "robot": "Robot",
    "robots": "Robots",
    "simulator": "Simulator",
    "observations": "Observation",
    "agent": "Learner",
    "agents": "Agents",
    "lanes": "Lanes",
    "name": "Name",
    "world": "World",
    "worlds": "Worlds",
    "disturb": "Disturbances",
    "experiment": "Experiment",
    "seeds": "Seeds",
    "tags": "Tags",
    "notes": "Notes",
}
"""Of the fields of all forms that are no declared settings."""
