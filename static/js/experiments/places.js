// A summary's settings, sorted by where they were tried: what may be compared with what.

/** Where agents are compared: how they observe, which robot, which foot grid. */
export const placeOf = ({ observation, robot, divisions, grid_side_m }) =>
  [observation, robot, divisions, grid_side_m].join("/");

const pairOf = (setting) => `${setting.gait} in ${placeOf(setting)}`;

/** The places that there are, in the order of the experiment: [{key, observation, robot, …}]. */
export function placesOf(settings) {
  const found = new Map();
  for (const setting of settings) {
    const { observation, robot, divisions, grid_side_m, half_side_m } = setting;
    const key = placeOf(setting);
    if (!found.has(key)) found.set(key, { key, observation, robot, divisions, grid_side_m, half_side_m });
  }
  return [...found.values()];
}

/** Each gait of a place with its agents, in the order of the experiment. */
export function gaitsOf(settings, place) {
  const here = settings.filter((setting) => placeOf(setting) === place);
  return [...new Set(here.map(({ gait }) => gait))].map((gait) => {
    const own = here.filter((setting) => setting.gait === gait);
    return {
      gait,
      learners: own.filter(({ role }) => role === "learner"),
      references: Object.fromEntries(own.filter(({ role }) => role === "reference").map((one) => [one.agent, one])),
    };
  });
}

/** Gait and place → greedy's total distance there [m]. */
export function greedyTotals(settings) {
  const found = new Map();
  for (const setting of settings) {
    if (setting.role === "reference" && setting.agent === "greedy" && setting.total) found.set(pairOf(setting), setting.total.mean_m);
  }
  return (setting) => found.get(pairOf(setting)) ?? null;
}
