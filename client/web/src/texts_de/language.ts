// The language of the texts in this folder: German.
import type * as english from "../texts/language";

export const language: typeof english.language = {
  folder: "de/",
  times: "de-DE",
};
