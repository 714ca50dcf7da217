// The modules whose texts every catalogue has: those of Watch and of a room's phone. The texts of other modules are
// translated as far as somebody has done it; what is missing is shown in English.

const ROOM = "static/features/classroom/room";

export const WATCH = [
  "static/js/actions.js", "static/js/api.js", "static/js/disturbances.js", "static/js/features.js",
  "static/js/format.js", "static/js/headline.js", "static/js/narrative/moment.js", "static/js/narrative/narrative.js",
  "static/js/narrative/sentences.js", "static/js/on-stage.js", "static/js/page-state.js", "static/js/player.js",
  "static/js/settings.js", "static/js/time.js", "static/js/titles.js", "static/js/training.js",
  "static/js/workspace.js",
  ...["app", "board", "charts", "crosshair", "elements", "foot", "help", "menu", "own-choices", "panel", "plan",
    "run-charts", "run-notices", "stage", "stage-notes", "time-bar", "work-buttons"]
    .map((name) => `static/js/components/${name}.js`),
  "static/features/classroom/feature.js", "static/features/classroom/first-lesson.js",
  "static/features/classroom/linked-lesson.js", "static/features/classroom/components/lesson-reader.js",
  ...["explanation", "loss", "navigator", "why"].map((name) => `static/features/explanations/components/${name}.js`),
  "static/features/explanations/steps.js", "static/features/guide/reading.js",
  "static/features/run_code/citation.js",
];

export const PHONE = [
  ...["allowed-settings", "card-actions", "chart", "clocks", "join", "lane-names", "main", "participant-run", "phone",
    "phone-results", "picture", "press-strip", "questions", "room", "run-sentences", "scores", "teach-phone"]
    .map((name) => `${ROOM}/${name}.js`),
  "static/js/components/away.js", "static/js/components/dot-strip.js", "static/js/components/number-row.js",
];
