// OrganismOffers: what the panel "organism" shows without a selection: the healthiest organisms, to choose one.
import {organism_texts as texts} from "../texts/organism";
import {h, set_text} from "../widgets/dom";
import type {ViewedWorld} from "../world/world";

const offered_max = 5;
const interval_ms = 1000; // the list does not change faster, so that it can be clicked

export class OrganismOffers {
  readonly #choose: (id: number) => void;
  readonly #refresh: () => void;
  readonly #buttons = Array.from(
    {length: offered_max}, (_, i) => h("button", {class: "button organism-offer", onclick: () => this.#click(i)}));
  readonly #waiting = h("p", {class: "hint"});
  readonly element =
    h("div", {class: "panel"}, h("p", {}, texts.choose), h("h3", {}, texts.healthiest),
      h("div", {class: "organism-offers"}, ...this.#buttons), this.#waiting);
  #offered: number[] = [];
  #offered_at_ms = -Infinity;
  #timer = 0;

  /** choose   the user has chosen this organism
   *  refresh  calls update() */
  constructor(choose: (id: number) => void, refresh: () => void) {
    this.#choose = choose;
    this.#refresh = refresh;
  }

  /** Lets the next update() show the present list at once. */
  renew(): void {
    this.#offered_at_ms = -Infinity;
  }

  focus(): void {
    this.#buttons[0]!.focus();
  }

  update(world: ViewedWorld): void {
    set_text(this.#waiting, world.feed.healthiest.length > 0 ? "" : world.snapshot ? texts.none_alive : texts.waiting);
    const due_ms = this.#offered_at_ms + interval_ms - performance.now();
    if (due_ms > 0 && this.#offered.length > 0) {
      if (this.#timer === 0) {
        this.#timer = window.setTimeout(() => {
          this.#timer = 0;
          this.#refresh();
        }, due_ms);
      }
      return;
    }
    this.#offered_at_ms = performance.now();
    this.#offered = world.feed.healthiest.slice(0, offered_max).map((organism) => organism.id);
    this.#buttons.forEach((button, i) => {
      const organism = world.feed.healthiest[i];
      button.hidden = organism === undefined;
      if (organism) {
        set_text(button, texts.offer(organism.id, organism.health));
      }
    });
  }

  #click(index: number): void {
    const id = this.#offered[index];
    if (id !== undefined) {
      this.#choose(id);
    }
  }
}
