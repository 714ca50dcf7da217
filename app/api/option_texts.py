"""Sentences and titles of the options that are no declared settings."""

from hexapods.runs import best_known

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
CLOCK_TEXTS = {
    "paper": "A decision costs a share of a step's time for every future that was simulated.",
    "wall": "A decision costs the time that this computer took for it.",
    "free": "Thinking costs nothing.",
}
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
    "agent": "Which agent learns.",
}
