// controls: widgets that several parts of the page use.
import {h, set_text} from "./dom";
import type {Notify} from "./notices";

/** Enables a button, or makes it explain why it cannot act: it stays reachable by keyboard, and guard() shows the
 *  reason. */
export function set_allowed(button: HTMLElement, why_not: string, help = ""): void {
  set_attribute(button, "aria-disabled", why_not ? "true" : null);
  set_attribute(button, "title", why_not || help || null);
}

/** Enables a control or takes it out of use. title: the help, or why it is out of use; absent: it stays as it is. */
export function set_enabled(
  control: HTMLButtonElement|HTMLInputElement|HTMLSelectElement, enabled: boolean, title?: string): void {
  control.disabled = !enabled;
  if (title !== undefined && control.title !== title) {
    control.title = title;
  }
}

/** Sets the value only if it differs, so that the cursor stays. */
export function set_value(control: HTMLInputElement|HTMLSelectElement, value: string): void {
  if (control.value !== value) {
    control.value = value;
  }
}

/** A button that calls `act`, or shows its reason by `notify` while set_allowed() has disabled it. */
export function guarded_button(label: string, notify: Notify, act: () => void, classes = "button"): HTMLButtonElement {
  const is_disabled = (): boolean => button.getAttribute("aria-disabled") === "true";
  const button =
    h("button", {
      type: "button",
      class: classes,
      onclick: () => {
        if (is_disabled()) {
          const why = button.title;
          notify(why, () => button.isConnected && is_disabled() && button.title === why);
        } else {
          act();
        }
      },
    },
      label);
  return button;
}

/** Sets an attribute only if it differs; null removes it. */
export function set_attribute(element: Element, name: string, value: string|null): void {
  if (element.getAttribute(name) !== value) {
    if (value === null) {
      element.removeAttribute(name);
    } else {
      element.setAttribute(name, value);
    }
  }
}

/** Replaces the options of a select only if they differ, so that an open list is not disturbed. */
export function set_options(select: HTMLSelectElement, options: {value: string; text: string}[], chosen: string): void {
  const same = select.options.length === options.length &&
    options.every((option, i) => select.options[i]!.value === option.value && select.options[i]!.text === option.text);
  if (!same) {
    select.replaceChildren(...options.map(({value, text}) => h("option", {value}, text)));
  }
  if (select.value !== chosen) {
    select.value = chosen;
  }
}

/** A dialog of the page. The browser keeps the focus inside and returns it when the dialog closes. */
export class Dialog {
  readonly body = h("div", {class: "dialog-body"});
  readonly element: HTMLDialogElement;
  #title = h("h2", {});

  constructor(title: string, classes = "") {
    const close =
      h("button", {type: "button", class: "button button-quiet", "aria-label": "Close", onclick: () => this.close()},
        "✕");
    this.element =
      h("dialog", {class: `dialog ${classes}`, "aria-label": title},
        h("div", {class: "dialog-head"}, this.#title, close), this.body);
    set_text(this.#title, title);
    this.element.addEventListener("click", (event) => {
      if (event.target === this.element) { // the backdrop
        this.close();
      }
    });
    document.body.append(this.element);
  }

  get is_open(): boolean {
    return this.element.open;
  }

  open(): void {
    if (!this.element.open) {
      this.element.showModal();
    }
  }

  close(): void {
    this.element.close();
  }
}
