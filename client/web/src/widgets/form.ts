// form: buttons, fields and questions, as the panels use them.
import {common_texts} from "../texts/common";

import {h} from "./dom";

type Attributes = Parameters<typeof h>[1];

export function button(text: string, act: () => void, attributes: Attributes = {}): HTMLButtonElement {
  return h("button", {class: "button", type: "button", onclick: act, ...attributes}, text);
}

/** A button with a symbol, which its help names. */
export function symbol_button(symbol: string, help: string, act: () => void, classes = "button"): HTMLButtonElement {
  return button(symbol, act, {class: classes, title: help, "aria-label": help});
}

/** A check box with its label. */
export function check(input: HTMLInputElement, text: string, help: string|null = null): HTMLElement {
  return h("label", {class: "check", title: help}, input, text);
}

/** A field for a name or a number, without the help of the browser. */
export function text_field(label: string, attributes: Attributes = {}): HTMLInputElement {
  return h(
    "input", {class: "field grow", "aria-label": label, spellcheck: "false", autocomplete: "off", ...attributes});
}

export function labelled(text: string, control: HTMLElement): HTMLLabelElement {
  return h("label", {for: control.id
  }, text);
}

export function row(...children: (Node|string)[]): HTMLElement {
  return h("div", {class: "row"}, ...children);
}

export function hint(text: string): HTMLElement {
  return h("p", {class: "hint"}, text);
}

/** A form that asks before something is done. It is hidden until open(), and returns the focus to `opener`. */
export class Question {
  readonly element: HTMLFormElement;
  readonly #opener: () => HTMLElement;

  /** field  gets the focus; absent: the button that does it, which is then shown as dangerous */
  constructor(
    readonly parts: {before: Node[]; field?: HTMLInputElement; after?: Node[]}, do_text: string, act: () => void,
    opener: () => HTMLElement) {
    this.#opener = opener;
    const {before, field, after = []} = parts, classes = `button button-${field ? "primary" : "danger"}`;
    const submit = (event: Event): void => {
      event.preventDefault();
      act();
    };
    this.element =
      h("form", {class: "confirm", hidden: true, onsubmit: submit}, ...before,
        h("div", {class: "row"}, field, h("button", {type: "submit", class: classes}, do_text),
          button(common_texts.cancel, () => this.close())),
        ...after);
  }

  open(): void {
    this.element.hidden = false;
    this.parts.field?.select();
    (this.parts.field ?? this.element.querySelector("button")!).focus();
  }

  close(): void {
    this.element.hidden = true;
    this.#opener().focus();
  }
}
