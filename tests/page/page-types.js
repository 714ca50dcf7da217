// Writes TypeScript types of the API's answers: `page-types.js SCHEMAS.json TYPES.d.ts`.
import { readFileSync, writeFileSync } from "node:fs";
import { compile } from "json-schema-to-typescript";

const [, , source, target] = process.argv;

const BANNER = "// Written by `make page-types` from the API's response models.";
/** What the generator says of each type: that it is in the root. */
const REMARK = "This interface was referenced by `Root`'s JSON-Schema\n \\* via the `definition` \"\\w+\"\\.";

/**
 * A schema of OpenAPI 3.1 in the older form that the generator reads. Titles are left out, since it makes a type of
 * each, and the most items of a list, for which it lists every shorter one.
 * @param {any} schema
 * @returns {any}
 */
function older(schema) {
  if (Array.isArray(schema)) return schema.map(older);
  if (schema === null || typeof schema !== "object") return schema;
  const { title: _, prefixItems, maxItems, $ref, properties, ...rest } = schema;
  return {
    ...Object.fromEntries(Object.entries(rest).map(([name, part]) => [name, older(part)])),
    ...($ref && { $ref: $ref.replace("#/components/schemas/", "#/definitions/") }),
    ...(prefixItems && { items: prefixItems.map(older), maxItems }),
    ...(properties && { properties: byName(properties) }),
  };
}

/** @param {Record<string, any>} schemas */
const byName = (schemas) =>
  Object.fromEntries(Object.entries(schemas).map(([name, schema]) => [name, older(schema)]));

const compiled = await compile({ definitions: byName(JSON.parse(readFileSync(source, "utf8"))) }, "Root", {
  additionalProperties: false,
  bannerComment: BANNER,
  unreachableDefinitions: true,
});

const types = compiled
  .replace(/\nexport interface Root \{[^}]*\}/, "")
  .replaceAll(new RegExp(`\\n \\*\\n \\* ${REMARK}`, "g"), "")
  .replaceAll(new RegExp(`\\n/\\*\\*\\n \\* ${REMARK}\\n \\*/`, "g"), "")
  .replaceAll(/\n *\/\*\*\n *\* @minItems \d+\n *\* @maxItems \d+\n *\*\//g, "");
writeFileSync(target, types);
