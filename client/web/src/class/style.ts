// style: loads class.css, which only joining and the pages of teachers need.
import {h} from "../widgets/dom";

let loaded: Promise<void>|null = null;

/** Resolves when the style is in effect, or cannot be loaded. */
export function class_style(): Promise<void> {
  loaded ??= new Promise((resolve) => {
    const done = (): void => resolve();
    document.head.append(h("link", {rel: "stylesheet", href: "class.css", onload: done, onerror: done}));
  });
  return loaded;
}
