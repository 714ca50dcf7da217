// What the server says of each experiment.
import { options } from "../../js/options.js";

/** What the server says of an experiment; undefined where it has none of this name. @param {string} name */
export const experimentKind = (name) => options.value?.experiments?.find((kind) => kind.name === name);
