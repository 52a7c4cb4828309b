// ParameterWhen: when the edits are applied: now, in a generation, or after a tick.
import {when_texts as texts} from "../texts/parameters";
import {set_enabled} from "../widgets/controls";
import {h} from "../widgets/dom";
import type {PanelContext} from "../world/panel_context";
import type {When} from "../world/parameter_edits";

const ticks_ahead = 1000; // of the tick that the field suggests

export class ParameterWhen {
  readonly element: HTMLElement;

  readonly #context: PanelContext;
  readonly #on_change: () => void;
  readonly #kind =
    h("select", {class: "field", "aria-label": texts.choice, onchange: () => this.#choose()},
      h("option", {value: "now"}, texts.now), h("option", {value: "generation"}, texts.in_generation),
      h("option", {value: "tick"}, texts.after_tick));
  readonly #number = h("input", {
    class: "field parameters-when",
    inputmode: "numeric",
    "aria-label": texts.number,
    hidden: true,
    oninput: () => this.#on_change()
  });

  constructor(context: PanelContext, on_change: () => void) {
    this.#context = context;
    this.#on_change = on_change;
    this.element = h("div", {class: "row"}, this.#kind, this.#number);
  }

  /** Whether the edits are planned rather than applied now. */
  get plans(): boolean {
    return this.#kind.value !== "now";
  }

  /** Returns when the edits are applied; a sentence if the number is not one. */
  chosen(): When|string {
    const kind = this.#kind.value;
    if (kind === "now") {
      return null;
    }
    const text = this.#number.value.replace(/,/g, "").trim();
    const number = /^\d{1,15}$/.test(text) ? Number(text) : NaN;
    if (!(number >= 1)) {
      return texts.wrong(kind, this.#number.value);
    }
    return kind === "generation" ? {generation: number} : {tick: number};
  }

  update(may: boolean): void {
    set_enabled(this.#kind, may);
    set_enabled(this.#number, may);
    this.element.hidden = !this.#context.server.features.has("planned_changes");
  }

  #choose(): void {
    const kind = this.#kind.value, world = this.#context.world();
    this.#number.hidden = kind === "now";
    const generation = world.snapshot?.generation ?? world.info?.generation ?? 1;
    this.#number.value = String(kind === "generation" ? generation + 1 : world.feed.tick + ticks_ahead);
    this.#on_change();
  }
}
