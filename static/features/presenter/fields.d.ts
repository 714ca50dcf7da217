// The types of the fields of the page's state that feature.json declares.
declare module "../../js/types.js" {
  interface FieldsOfFeatures {
    /** Whether the page is presented: full screen, large type. */
    isPresenting: boolean;
    /** Whether the page is the remote of a presentation. */
    isRemote: boolean;
  }
}
export {};
