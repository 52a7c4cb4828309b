// theme: dark, light, or as the browser prefers, and its colours for drawings on canvases.
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
const theme_event = "evod-theme";
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
    document.dispatchEvent(new Event(theme_event));
  };
  const stored = of_browser.get("theme");
  apply(stored === "dark" || stored === "light" ? stored : "");
  return button;
}

/** Calls `redraw` after each change of the theme, until the returned function is called. */
export function on_theme_change(redraw: () => void): () => void {
  const end = new AbortController(), {signal} = end;
  document.addEventListener(theme_event, redraw, {signal});
  matchMedia("(prefers-color-scheme: light)").addEventListener("change", redraw, {signal});
  return () => end.abort();
}

export type CssColours<Variables> = {
  [name in keyof Variables]: string
};

/** The values that CSS variables have at an element.
 *
 *  variables  {text: "--text"} */
export function css_colours<Variables extends {[name: string]: string}>(
  element: Element, variables: Variables): CssColours<Variables> {
  const style = getComputedStyle(element);
  const values = Object.entries(variables).map(([name, variable]) => [name, style.getPropertyValue(variable).trim()]);
  return Object.fromEntries(values) as CssColours<Variables>;
}
