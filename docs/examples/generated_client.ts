// Start, watch and stop a race over REST, by a client that is typed by the server's OpenAPI document.
//
//     npm install openapi-fetch openapi-typescript
//     npx openapi-typescript http://127.0.0.1:8000/openapi.json --default-non-nullable=false -o api.ts
//     node --experimental-strip-types generated_client.ts http://127.0.0.1:8000
//
// Needs Node 22 and a running `hexapods serve`.

import createClient from "openapi-fetch";
import type { paths } from "./api.ts";

const [address, token] = process.argv.slice(2);
const headers = token ? { authorization: `Bearer ${token}` } : {};
const api = createClient<paths>({ baseUrl: address, headers });

const pause = () => new Promise((resolve) => setTimeout(resolve, 100));

async function getRace(id: string) {
  const { data, error } = await api.GET("/api/v1/races/{run_id}", { params: { path: { run_id: id } } });
  if (!data || !("progress" in data)) throw new Error(error?.detail ?? "its data is damaged");
  return data;
}

const { data: started, error } = await api.POST("/api/v1/races", {
  body: { simulator: "kinematic", lanes: [{ agent: "greedy" }, { agent: "look-ahead" }], steps: 5000 },
});
if (!started) throw new Error(error.detail);
console.log(`started ${started.id}`);
let race = await getRace(started.id);
while (["queued", "running"].includes(race.state) && race.progress.done === 0) {
  await pause();
  race = await getRace(race.id);
}
console.log(`${race.state}: ${race.progress.done} of ${race.progress.total} steps`);
await api.POST("/api/v1/races/{run_id}/stop", { params: { path: { run_id: race.id } } });
while (["queued", "running"].includes(race.state)) {
  await pause();
  race = await getRace(race.id);
}
console.log(`${race.state} after ${race.progress.done} steps`);
