// Notices: short messages at the bottom that disappear by themselves, and banners at the top that stay while something
// is wrong.
import {widget_texts} from "../texts/widgets";

import {h, set_text} from "./dom";

const shown_ms = 6000, notices_max = 3;

/** A button of a notice or of a banner. */
export interface Action {
  label: string;
  act: () => void;
}

/** Shows a message.
 *
 *  holds   whether what the message states is still true; absent: the message reports something that has happened
 *  action  a button of the message
 *  stays   it is a refusal, which stays until the next action instead of some seconds */
export type Notify = (text: string, holds?: () => boolean, action?: Action, stays?: boolean) => void;

export class Notices {
  readonly element = h("div", {class: "notices", role: "status", "aria-live": "polite"});
  readonly #conditions = new Map<Element, () => boolean>(); // by notice

  /** Removes the messages about what is not true any more. */
  refresh(): void {
    for (const [notice, holds] of this.#conditions) {
      if (!notice.isConnected || !holds()) {
        notice.remove();
        this.#conditions.delete(notice);
      }
    }
  }

  /** Removes the refusal of the last action. */
  forget_refusal(): void {
    this.element.querySelectorAll("[data-stays]").forEach((notice) => notice.remove());
  }

  /** Shows a message; see Notify. The same message is not shown twice at a time. */
  show(text: string, holds?: () => boolean, action?: Action, stays = false): void {
    this.forget_refusal();
    for (const notice of [...this.element.children]) {
      if (notice.firstChild?.textContent === text) {
        notice.remove();
      }
    }
    const notice = h("div", {class: "notice"}, h("span", {}, text));
    if (action !== undefined) {
      const act = (): void => {
        notice.remove();
        action.act();
      };
      notice.append(h("button", {type: "button", class: "button", onclick: act}, action.label));
    }
    notice.append(
      h("button", {
        type: "button",
        class: "button button-quiet",
        "aria-label": widget_texts.close_message,
        onclick: () => notice.remove()
      },
        "✕"));
    this.element.append(notice);
    if (holds !== undefined) {
      this.#conditions.set(notice, holds);
    }
    while (this.element.children.length > notices_max) {
      this.element.firstElementChild!.remove();
    }
    if (stays) {
      notice.dataset.stays = "";
    } else {
      this.#expire(notice);
    }
  }

  /** Removes the message after a time, but not while the pointer or the focus is on it. */
  #expire(notice: HTMLElement): void {
    setTimeout(() => (notice.matches(":hover, :focus-within") ? this.#expire(notice) : notice.remove()), shown_ms);
  }
}

export interface Banner {
  name: string; // "lost"
  kind: "bad"|"warn"|"info";
  text: string;
  progress?: {value: number; max: number};
  actions?: Action[];
}

export class Banners {
  readonly element = h("div", {class: "banners", role: "status", "aria-live": "polite"});
  #shown = new Map<string, HTMLElement>();

  /** Shows exactly these banners. */
  set(banners: Banner[]): void {
    for (const [name, element] of this.#shown) {
      if (!banners.some((banner) => banner.name === name)) {
        element.remove();
        this.#shown.delete(name);
      }
    }
    for (const banner of banners) {
      let element = this.#shown.get(banner.name);
      if (!element) {
        element =
          h("div", {class: "banner", "data-kind": banner.kind}, h("span", {}), banner.progress && h("progress", {}),
            ...(banner.actions ?? [])
              .map(({label, act}) => h("button", {type: "button", class: "button", onclick: act}, label)));
        this.#shown.set(banner.name, element);
        this.element.append(element);
      }
      set_text(element.firstElementChild!, banner.text);
      const progress = element.querySelector("progress");
      if (progress && banner.progress) {
        Object.assign(progress, banner.progress);
      }
    }
  }
}
