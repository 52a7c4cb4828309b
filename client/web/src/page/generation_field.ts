// GenerationField: the field of the time line in which the user types the generation to show.
//
// Owner    Timeline.
import {capitalised, number_in} from "../texts/numbers";
import {generation_field_texts as texts} from "../texts/timeline";
import {set_attribute, set_value} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import type {ViewedWorld} from "../world/world";

import type {Seeker} from "./seeker";

export class GenerationField {
  readonly element: HTMLElement;
  /** Why the typed text is not a generation of the run. */
  readonly wrong = h("p", {class: "error time-wrong", role: "alert"});

  readonly #world: ViewedWorld;
  readonly #seeker: Seeker;
  readonly #label = h("span", {});
  readonly #field = h("input", {
    class: "field time-generation",
    inputmode: "numeric",
    autocomplete: "off",
    onkeydown: (event: KeyboardEvent) => this.#key(event),
    onblur: () => this.#left()
  });

  constructor(world: ViewedWorld, seeker: Seeker) {
    this.#world = world;
    this.#seeker = seeker;
    this.element = h("label", {class: "hint time-field"}, this.#label, this.#field);
  }

  /** Shows the generation, unless the user types. */
  refresh(): void {
    const {snapshot, past: {target}} = this.#world, {first, last} = this.#allowed();
    set_text(this.#label, texts.label(this.#world.has_births));
    set_attribute(this.#field, "title", texts.help(first, last, this.#world.has_births));
    if (document.activeElement !== this.#field && snapshot) {
      set_value(this.#field, String(target?.generation ?? snapshot.generation));
    }
  }

  /** The history of a live world may begin later than its run. */
  #allowed(): {first: number; last: number} {
    const {past: {range}, is_replay} = this.#world;
    return {first: is_replay && range ? range.first_generation : 1, last: range?.last_generation ?? 1};
  }

  /** Enter shows the generation that was typed; Escape forgets it. */
  #key(event: KeyboardEvent): void {
    if (event.key === "Escape") {
      this.#field.blur();
    } else if (event.key === "Enter") {
      const {first, last} = this.#allowed(), name = texts.label(this.#world.has_births);
      const generation = number_in(name, this.#field.value.replace(/,/g, ""), first, last);
      set_text(this.wrong, typeof generation === "string" ? `${capitalised(generation)}.` : "");
      set_attribute(this.#field, "aria-invalid", typeof generation === "string" ? "true" : null);
      if (typeof generation === "number") {
        this.#seeker.go({generation});
        this.#field.select();
      }
    }
  }

  #left(): void {
    set_text(this.wrong, "");
    set_attribute(this.#field, "aria-invalid", null);
    this.refresh();
  }
}
