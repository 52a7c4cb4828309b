// What keys answer.
import type * as english from "../texts/keys";

import {gene_name} from "./genes";

const colours: {readonly [name: string]: string|undefined} = {
  health: "Gesundheit",
  lineage: "Abstammung"
};

export const key_texts: typeof english.key_texts = {
  panel: (title) => `Bereich ${title} zeigen`,
  end_of_replay: "Die Wiedergabe ist am Ende; [ geht eine Generation zurück.",
  run_has_ended: "Der Lauf ist zu Ende; Zurücksetzen der Welt beginnt ihn neu.",
  is_live: "Die Welt ist live; P gibt ihren Lauf wieder.",
  colour: (name) => `Farbe: ${name === "" ? "keine" : colours[name] ?? gene_name(name)}`,
};
