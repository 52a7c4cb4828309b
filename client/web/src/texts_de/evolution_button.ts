// The button that shows generation 1 next to the present.
import type * as english from "../texts/evolution_button";

export const evolution_button_texts: typeof english.evolution_button_texts = {
  show: "Evolution zeigen",
  show_help: "Zeigt Generation 1 und die Gegenwart nebeneinander.",
  end: "Vergleich beenden",
  end_help: "Zeigt wieder nur die Gegenwart (B).",
};
