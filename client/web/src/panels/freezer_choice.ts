// FreezerChoice: which organism of the shown entry of the freezer is meant.
import {genes_of_organism, is_organism, type Population} from "../freezer/population_csv";
import type {Kept} from "../freezer/freezer";
import {freezer_texts as texts} from "../texts/freezer";
import {number_in} from "../texts/numbers";
import {set_attribute} from "../widgets/controls";
import {h} from "../widgets/dom";
import {labelled, row} from "../widgets/form";

/** An entry of the freezer with its genes. */
export interface ShownEntry {
  kept: Kept;
  population: Population;
}

export interface ChosenOrganism {
  name: string; // for people: "leader", "organism 3 of ancestors"
  genes: Float32Array;
}

export class FreezerChoice {
  readonly element: HTMLElement;

  readonly #on_change: () => void;
  readonly #island = this.#field("freezer-island");
  readonly #organism = this.#field("freezer-organism");
  #shown: ShownEntry|null = null;

  constructor(on_change: () => void) {
    this.#on_change = on_change;
    this.element =
      row(labelled(texts.island, this.#island), this.#island, labelled(texts.organism, this.#organism), this.#organism);
  }

  show(shown: ShownEntry): void {
    this.#shown = shown;
    this.#island.value = this.#organism.value = "0";
    this.element.hidden = is_organism(shown.population);
  }

  /** The organism; or a sentence about a wrong number, without a full stop. */
  chosen(): ChosenOrganism|string {
    const {kept, population} = this.#shown!, islands = population.islands.length;
    const island = number_in(texts.island, this.#island.value, 0, islands - 1);
    const count = typeof island === "string" ? 0 : kept.organism_counts[island]!;
    const organism = typeof island === "string" ? 0 : number_in(texts.organism, this.#organism.value, 0, count - 1);
    set_attribute(this.#island, "aria-invalid", typeof island === "string" ? "true" : null);
    set_attribute(this.#organism, "aria-invalid", typeof organism === "string" ? "true" : null);
    if (typeof island === "string") {
      return island;
    }
    return typeof organism === "string" ? organism : {
      name: is_organism(population) ? kept.name : texts.organism_name(kept.name, island, organism, islands),
      genes: genes_of_organism(population, island, organism)
    };
  }

  #field(id: string): HTMLInputElement {
    return h("input", {class: "field freezer-number", inputmode: "numeric", id, oninput: () => this.#on_change()});
  }
}
