// A run as code, over the REST API.
import { call } from "../../js/api.js";

/** @type {(id: string) => Promise<{ command: string, python: string }>} */
export const getCode = (id) => call("GET", `runs/${encodeURIComponent(id)}/code`);
