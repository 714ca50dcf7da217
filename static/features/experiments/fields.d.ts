// The types of the fields of the page's state that feature.json declares.
declare module "../../js/types.js" {
  interface FieldsOfFeatures {
    /** What was set of the next experiment, by field, as it was typed. */
    experiment: URLSearchParams;
    /** Id of the experiment whose report is shown; null for the newest. */
    report: string | null;
  }
}
export {};
