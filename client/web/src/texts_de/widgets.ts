// Texts of widgets.
import type * as english from "../texts/widgets";

export const widget_texts: typeof english.widget_texts = {
  close_message: "Nachricht schließen",
  theme: {"": "Farben: wie das System", dark: "Farben: dunkel", light: "Farben: hell"},
};
