// The types of the fields of the page's state that feature.json declares.
declare module "../../js/types.js" {
  interface FieldsOfFeatures {
    /** The settings that are tried and are not those of the next run, as "alpha=0.8". */
    tried: string[];
  }
}
export {};
