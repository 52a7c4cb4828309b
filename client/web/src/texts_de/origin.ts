// What people read about the generations before a fork.
import type * as english from "../texts/origin";

import {with_separators} from "./numbers";

export const origin_texts: typeof english.origin_texts = {
  bred_in: (generation, world) =>
    `Generation ${with_separators(generation)} pflanzte sich in der Welt ${world} fort, bevor diese Abzweigung begann.`,
  no_world: (generation) => `Generation ${with_separators(generation)} pflanzte sich fort, bevor diese Abzweigung ` +
    "begann, in einem Lauf, den jetzt keine Welt dieses Servers hat.",
  open: (world) => `In ${world} öffnen`,
  open_help: "Zeigt die Generation in der Welt, aus der abgezweigt wurde, neben dieser.",
};
