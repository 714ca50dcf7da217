// The types of the fields of the page's state that feature.json declares.
declare module "../../js/types.js" {
  interface FieldsOfFeatures {
    /** Id of the lesson whose cards are shown; null for the first lesson. */
    lesson: string | null;
    /** The number of the lesson's card, from 1; null where no lesson is open. */
    card: number | null;
  }
}
export {};
