// OriginNote: says that a generation bred in the world of which the shown one is a fork, and opens it there.
import {origin_texts} from "../texts/origin";
import {h, set_text} from "../widgets/dom";
import {origin_text, world_with_run} from "../world/origin";
import type {PanelContext} from "../world/panel_context";

export class OriginNote {
  readonly #text = h("p", {role: "status"});
  readonly #open: HTMLButtonElement;
  readonly element: HTMLElement;
  readonly #context: PanelContext;
  #world = ""; // the origin
  #generation = 0;
  #organism: number|null = null;

  /** on_open: called after the generation is shown in the world of the origin, which has the focus. */
  constructor(context: PanelContext, on_open: (generation: number) => void) {
    this.#context = context;
    this.#open =
      h("button",
        {type: "button", class: "button", title: origin_texts.open_help, onclick: () => void this.#show(on_open)});
    this.element =
      h("div", {class: "panel origin-note", hidden: true}, this.#text, h("div", {class: "row"}, this.#open));
  }

  /** run_id: of the origin; empty: the note is hidden. generation: that bred there. organism: of that generation, to be
   *  selected there; null: none. */
  update(run_id: string, generation: number, organism: number|null = null): void {
    this.element.hidden = run_id === "";
    if (run_id !== "") {
      this.#world = world_with_run(this.#context.server, run_id);
      this.#generation = generation;
      this.#organism = organism;
      set_text(this.#text, origin_text(this.#world, generation));
      set_text(this.#open, origin_texts.open(this.#world));
      this.#open.hidden = this.#world === "";
    }
  }

  async #show(on_open: (generation: number) => void): Promise<void> {
    const {island} = this.#context.world(), generation = this.#generation, organism = this.#organism;
    this.#context.show_beside(this.#world, island);
    const origin = this.#context.world();
    if (await this.#context.attempt(() => origin.past.show(generation))) {
      origin.selection.select(organism);
      on_open(generation);
    }
  }
}
