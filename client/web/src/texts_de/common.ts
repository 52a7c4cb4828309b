// Texts that several parts of the page use.
import type * as english from "../texts/common";

import {with_separators} from "./numbers";

export const common_texts: typeof english.common_texts = {
  cancel: "Abbrechen",
  no_world: "Keine Welt ist offen.",
  no_world_yet: "Noch ist keine Welt offen.",
  replay_cannot_change: "Eine Wiedergabe kann nicht geändert werden.",
  end_of_replay: "Ende der Wiedergabe",
  wrong_seed: (seed, most) =>
    `Startwert: „${seed}“ ist nicht möglich, erlaubt sind ganze Zahlen von 0 bis ${with_separators(most)}`,
};
