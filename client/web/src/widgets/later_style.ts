// later_style: loads a style sheet that only some visitors need.
import {h} from "./dom";

const loaded = new Map<string, Promise<void>>();

/** Resolves when the style is in effect, or cannot be loaded. */
export function later_style(file: string): Promise<void> {
  let style = loaded.get(file);
  if (style === undefined) {
    style = new Promise((resolve) => {
      const done = (): void => resolve();
      document.head.append(h("link", {rel: "stylesheet", href: file, onload: done, onerror: done}));
    });
    loaded.set(file, style);
  }
  return style;
}
