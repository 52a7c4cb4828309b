// theme: dark, light, or as the browser prefers.
import {widget_texts} from "../texts/widgets";
import {of_browser} from "../world/storage";

import {set_attribute} from "./controls";
import {h, set_text} from "./dom";

type Theme = ""|"dark"|"light"; // "": as the browser prefers
const signs: {[theme in Theme]: string} = {
  "": "◐",
  dark: "☾",
  light: "☀"
};
const order: Theme[] = ["", "dark", "light"];

/** A button that goes through the themes. Applies the remembered theme at once. */
export function theme_button(): HTMLButtonElement {
  const button = h("button", {
    type: "button",
    class: "button button-quiet square",
    onclick: () => apply(order[(order.indexOf(theme) + 1) % order.length]!)
  });
  let theme: Theme = "";
  const apply = (wanted: Theme): void => {
    theme = wanted;
    of_browser.set("theme", theme);
    set_attribute(document.documentElement, "data-theme", theme || null);
    const label = widget_texts.theme[theme];
    set_text(button, signs[theme]);
    button.title = label;
    set_attribute(button, "aria-label", label);
    document.dispatchEvent(new Event("evod-theme")); // canvases of plots draw again
  };
  const stored = of_browser.get("theme");
  apply(stored === "dark" || stored === "light" ? stored : "");
  return button;
}
