// The language of the texts in this folder.
import type * as english from "../texts/language";

export const language: typeof english.language = {
  folder: "de/",
  times: "de-DE",
};
