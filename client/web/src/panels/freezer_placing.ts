// FreezerPlacing: places copies of an organism of the freezer in the shown world: by clicks, or at random places.
import {common_texts} from "../texts/common";
import {freezer_texts as texts} from "../texts/freezer";
import {number_in} from "../texts/numbers";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h} from "../widgets/dom";
import {row} from "../widgets/form";
import {gene_problem} from "../world/names";
import type {PanelContext} from "../world/panel_context";
import {Placing} from "../world/placing";
import {Refusal} from "../world/server";

import type {ChosenOrganism} from "./freezer_choice";

const copies_max = 100;
const tries_max = 30; // for a free place, per copy
const margin_px = 20; // from the walls
const place_field = /^place\.organisms\[0\](\.[xy]_px)?$/; // of refusals because something is in the way

/** What is placed: the chosen organism and the names of its genes; a sentence if none is chosen. */
export type Model = {
  organism: ChosenOrganism; gene_names: string[]
}|string;

export class FreezerPlacing {
  readonly element: HTMLElement;

  readonly #context: PanelContext;
  readonly #model: () => Model;
  readonly #on_problem: (problem: string) => void;
  readonly #by_clicks: HTMLButtonElement;
  readonly #scatter: HTMLButtonElement;
  readonly #copies =
    h("input", {class: "field freezer-number", inputmode: "numeric", value: "10", "aria-label": texts.copies});
  #busy = false; // copies are being placed

  /** on_problem  is called with why nothing was placed, as a sentence; with the empty text when it is tried again */
  constructor(context: PanelContext, model: () => Model, on_problem: (problem: string) => void) {
    this.#context = context;
    this.#model = model;
    this.#on_problem = on_problem;
    this.#by_clicks = guarded_button(texts.place, context.notify, () => this.#place_by_clicks());
    this.#scatter = guarded_button(texts.scatter, context.notify, () => void this.#place_anywhere());
    this.element =
      h("div", {class: "panel"}, row(this.#by_clicks),
        row(h("label", {class: "row"}, this.#copies, texts.copies), this.#scatter));
  }

  /** name, gene_names: of the entry */
  refresh(name: string, gene_names: readonly string[]): void {
    const {server} = this.#context, world = this.#context.world();
    const why = !world.info         ? common_texts.no_world :
      !server.features.has("place") ? texts.cannot_place :
      world.is_replay               ? texts.replay :
                                      server.access.why_not("place", world.shown) ||
        gene_problem(name, gene_names, world.name, world.gene_names);
    set_allowed(this.#by_clicks, why, texts.place_help);
    set_allowed(this.#scatter, why, texts.scatter_help);
  }

  #place_by_clicks(): void {
    const model = this.#model();
    if (typeof model === "string") {
      return;
    }
    const {organism: {name, genes}, gene_names} = model;
    const is_chosen = this.#context.place_by_clicks({name: texts.a_copy_of(name), genes: [...genes], gene_names});
    if (is_chosen !== null) {
      this.#context.notify(texts.placing(name), is_chosen);
    }
  }

  async #place_anywhere(): Promise<void> {
    const model = this.#model(), wanted = number_in(texts.copies, this.#copies.value, 1, copies_max);
    set_attribute(this.#copies, "aria-invalid", typeof wanted === "string" ? "true" : null);
    this.#on_problem(typeof wanted === "string" ? `${wanted}.` : "");
    if (typeof model === "string" || typeof wanted === "string" || this.#busy) {
      return;
    }
    this.#busy = true;
    try {
      await this.#place_copies(model.organism, wanted);
    } catch (error) {
      this.#on_problem((error as Error).message);
    }
    this.#busy = false;
  }

  async #place_copies({name, genes}: ChosenOrganism, wanted: number): Promise<void> {
    const world = this.#context.world(), {snapshot, island} = world;
    if (!snapshot) {
      return;
    }
    const placing = new Placing(world), size = {x: snapshot.width_px, y: snapshot.height_px};
    try {
      for (let placed = 0; placed < wanted; ++placed) {
        if (!await this.#place_copy(placing, [...genes], size)) {
          throw new Error(texts.no_room(placed, wanted));
        }
      }
    } finally {
      placing.end(); // all copies are one change
    }
    this.#context.notify(texts.scattered(name, wanted, world.name, island));
  }

  /** Returns whether a free place was found. */
  async #place_copy(placing: Placing, genes: number[], size: {x: number; y: number}): Promise<boolean> {
    const random = (length: number): number =>
      length > 2 * margin_px ? margin_px + Math.random() * (length - 2 * margin_px) : length / 2;
    for (let tries = 0; tries < tries_max; ++tries) {
      try {
        const organisms = [{x_px: random(size.x), y_px: random(size.y), genes}];
        await placing.place({organisms});
        return true;
      } catch (error) {
        const is_occupied = error instanceof Refusal && error.violations.some(({field}) => place_field.test(field));
        if (!is_occupied) {
          throw error;
        }
      }
    }
    return false;
  }
}
