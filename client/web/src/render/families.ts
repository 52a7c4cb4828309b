// Families: the lineages of a population, and their colours. A family consists of all organisms with the same founder,
// an organism of the first generation, found along first parents.
import {Colour, lineages, unknown} from "./look";

export interface Family {
  founder: number;
  size: number;
}

export const families_shown_max = 7;
export const no_founder = 0xffffffff;

export class Families {
  /** The largest families, by decreasing size; among equal sizes, the lower founder comes first. */
  readonly shown: Family[];
  readonly count: number; // of all families
  readonly size: number; // organisms in all families
  /** For each organism, the index of its family in `shown`; families_shown_max if it is smaller or unknown. */
  readonly #of_organism: Uint8Array;

  constructor(founders: Uint32Array) {
    const sizes = new Map<number, number>();
    let size = 0;
    for (const founder of founders) {
      if (founder !== no_founder) {
        sizes.set(founder, (sizes.get(founder) ?? 0) + 1);
        ++size;
      }
    }
    const all = [...sizes].map(([founder, count]) => ({founder, size: count}));
    all.sort((a, b) => b.size - a.size || a.founder - b.founder);
    this.shown = all.slice(0, families_shown_max);
    this.count = all.length;
    this.size = size;
    const places = new Map(this.shown.map(({founder}, i) => [founder, i]));
    this.#of_organism = Uint8Array.from(founders, (founder) => places.get(founder) ?? families_shown_max);
  }

  of(id: number): number {
    return this.#of_organism[id] ?? families_shown_max;
  }
}

/** Assigns colours to families. A family keeps its colour over generations as long as it is among the largest. */
export class FamilyColours {
  readonly #places: (number|null)[] = lineages.map(() => null); // for each colour, the founder that has it
  #colours: Colour[] = [];

  update({shown}: Families): void {
    this.#places.forEach((founder, i) => {
      if (founder !== null && !shown.some((family) => family.founder === founder)) {
        this.#places[i] = null;
      }
    });
    this.#colours = shown.map(({founder}) => {
      let place = this.#places.indexOf(founder);
      if (place < 0) {
        place = this.#places.indexOf(null);
        this.#places[place] = founder;
      }
      return lineages[place]!;
    });
  }

  of(family: number): Colour {
    return this.#colours[family] ?? unknown;
  }
}
