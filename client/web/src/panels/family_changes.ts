// FamilyChanges: which genes of an organism mutated when it was bred. Reads the breeding of its generation when the
// pointer or the keyboard stays at the organism, a page of organisms at a time.
import {inheritance_of} from "../breeding/inheritance";
import type {Descendant} from "../core/protocol";
import {name_key, type OrganismName} from "../family/lineage";
import {gene_label} from "../organism/texts";
import {breeding_texts, gene_text} from "../texts/breeding";
import {family_texts} from "../texts/family";
import type {ViewedWorld} from "../world/world";

const wait_ms = 250; // before the breeding is requested
const texts_max = 20_000; // kept
const changes_shown_max = 8;
const no_row = 0xffffffff; // the first row of a list that is not wanted

export class FamilyChanges {
  #texts = new Map<string, string>(); // by organism
  #timer: ReturnType<typeof setTimeout>|undefined;
  #wanted = "";
  readonly #show: (text: string) => void;

  /** show  receives the sentence about the organism that was read last; "": none */
  constructor(show: (text: string) => void) {
    this.#show = show;
  }

  /** Another run is shown. */
  forget(): void {
    this.#texts.clear();
    this.read(null, null);
  }

  read(world: ViewedWorld|null, organism: OrganismName|null): void {
    clearTimeout(this.#timer);
    this.#wanted = organism ? name_key(organism) : "";
    const known = this.#texts.get(this.#wanted);
    if (!world || !organism || known !== undefined) {
      this.#show(known ?? "");
      return;
    }
    this.#show(family_texts.loading_changes);
    this.#timer = setTimeout(() => void this.#load(world, organism), wait_ms);
  }

  async #load(world: ViewedWorld, {generation, island, organism}: OrganismName): Promise<void> {
    const wanted = this.#wanted;
    let text: string|undefined;
    try {
      const breeding = await world.server.request("get_breeding", {
        world: world.shown,
        island,
        generation: generation - 1,
        first_contender: no_row,
        first_pick: no_row,
        first_descendant: organism,
      });
      if (this.#texts.size > texts_max) {
        this.#texts.clear();
      }
      for (const descendant of breeding.descendants ?? []) {
        this.#texts.set(
          name_key({generation, island, organism: descendant.id ?? 0}), changes_text(descendant, world.gene_names));
      }
      text = this.#texts.get(wanted) ?? "";
    } catch (error) {
      text = family_texts.changes_unknown(error instanceof Error ? error.message : String(error));
    }
    if (wanted === this.#wanted) {
      this.#show(text);
    }
  }
}

/** "Mutated genes: impulse 101.2 → 98.7 (creep)." */
function changes_text(descendant: Descendant, gene_names: readonly string[]): string {
  const changes = inheritance_of(descendant)?.changes ?? [], order = descendant.order_mutation;
  return family_texts.changed_genes(
           changes.slice(0, changes_shown_max).map((change) => ({
                                                     gene: gene_label(gene_names[change.gene] ?? String(change.gene)),
                                                     before: gene_text(change.before),
                                                     after: gene_text(change.after),
                                                     how: breeding_texts.mutation[change.kind],
                                                   })),
           Math.max(0, changes.length - changes_shown_max)) +
    (order ? family_texts.order_mutated(order.method ?? "") : "");
}
