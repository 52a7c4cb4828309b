// Introduction: three steps in a small card for people who see the page for the first time. The browser remembers that
// it was shown.
//
// The card is above the world, or below it in a narrow window, and covers nothing. It takes neither the focus nor keys.
import {
  introduction_steps, introduction_steps_without_bodies, introduction_texts as texts
} from "../texts/introduction";
import {h, set_text} from "../widgets/dom";
import {of_browser} from "../world/storage";

const key = "introduction";

export class Introduction {
  readonly element: HTMLElement;
  #step = 0;
  #steps = introduction_steps;
  readonly #title = h("h2", {});
  readonly #text = h("p", {});
  readonly #number = h("span", {class: "hint grow"});
  readonly #back: HTMLButtonElement;
  readonly #skip: HTMLButtonElement;
  readonly #next: HTMLButtonElement;
  readonly #offer: HTMLElement;

  /** offer: a button of the last step. */
  constructor(offer: HTMLElement) {
    const button = (label: string, act: () => void, classes = ""): HTMLButtonElement =>
      h("button", {type: "button", class: `button ${classes}`, onclick: act}, label);
    this.#offer = offer;
    this.#back = button(texts.back, () => this.#show(this.#step - 1));
    this.#skip = button(texts.skip, () => this.#end(), "button-quiet");
    this.#next = button(texts.next, () => this.#go_on(), "button-primary");
    this.element =
      h("section", {
        class: "introduction",
        "aria-label": texts.name,
        onkeydown: (event: KeyboardEvent) => {
          if (event.key === "Escape") {
            event.preventDefault();
            this.#end();
          }
        }
      },
        h("div", {"aria-live": "polite"}, this.#title, this.#text), offer,
        h("div", {class: "row"}, this.#number, this.#skip, this.#back, this.#next));
    offer.addEventListener("click", () => this.#end());
    this.#show(0);
    this.element.hidden = of_browser.get(key) !== "";
  }

  /** has_bodies: of the world that the page shows. */
  refresh(has_bodies: boolean): void {
    const steps = has_bodies ? introduction_steps : introduction_steps_without_bodies;
    if (steps !== this.#steps) {
      this.#steps = steps;
      this.#show(this.#step);
    }
  }

  /** Shows the first step again. */
  begin(): void {
    this.#show(0);
    this.element.hidden = false;
    this.#next.focus();
  }

  #go_on(): void {
    if (this.#step === this.#steps.length - 1) {
      this.#end();
    } else {
      this.#show(this.#step + 1);
    }
  }

  #show(step: number): void {
    const steps = this.#steps, {title, text} = steps[step]!, is_last = step === steps.length - 1;
    this.#step = step;
    set_text(this.#title, title);
    set_text(this.#text, text);
    set_text(this.#number, texts.step(step + 1, steps.length));
    set_text(this.#next, is_last ? texts.done : texts.next);
    this.#back.disabled = step === 0;
    this.#skip.hidden = is_last;
    this.#offer.hidden = !is_last;
  }

  #end(): void {
    this.element.hidden = true;
    of_browser.set(key, "seen");
  }
}
