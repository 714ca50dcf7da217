// What the server says of each experiment.
import { optionNamed, options } from "../../js/settings.js";

/** What the server says of an experiment; undefined where it has none of this name. @param {string} name */
export const experimentKind = (name) => optionNamed(options.value?.experiments, name);
