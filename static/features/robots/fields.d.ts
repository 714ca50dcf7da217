// The types of the fields of the page's state that feature.json declares.
declare module "../../js/types.js" {
  interface FieldsOfFeatures {
    /** Id of the robot that is read from a file and not stored yet, "new" until it has one; null for none. */
    reading: string | null;
  }
}
export {};
