// OrganismHistory: what has been received about one organism since it was selected: its health over time, its death,
// its offspring, and how often it and its parents were picked for breeding. No DOM.
import type {PopulationColumns} from "../core/messages";
import type {Brain, Breeding, Descendant, GetBreeding, OrganismInfo} from "../core/protocol";

export const health_points_max = 1024; // when reached, every second point is removed
export const offspring_generation_max = 20_000; // of a larger next generation, the offspring are not searched
const no_rows = 0xffff_ffff; // as the first row of a list: the answer has no rows of that list

/** An organism is named by its island, its generation and its id in that generation. */
export interface OrganismPlace {
  run_id: string;
  island: number;
  generation: number;
  id: number;
}

/** How often an organism was picked when its generation bred. */
export interface Picks {
  organism: number;
  count: number;
  all: number; // all picks of the breeding
  expected: number;
  migrant: {island: number; organism: number}|null; // the organism is a copy of this organism of another island
}

/** A child in the next generation. */
export interface Child {
  id: number;
  other_parent: number|null; // null: the child has only one parent
  unchanged: boolean; // it has the same genes as its only parent
}

/** How an organism came into its generation. */
export type Origin = "unknown"|"elite"|"survivor"|"child";

/** The fields of a GetBreeding but the world. */
export type BreedingRequest = Omit<GetBreeding, "world">&{first_contender: number};

export interface Range {
  min: number;
  mean: number;
  max: number;
}

export class OrganismHistory {
  readonly health: {s: number; health: number}[] = []; // seconds lived, rising
  info: OrganismInfo|null = null; // the newest OrganismInfo
  brain: Brain|null = null; // the last network that the server sent; it sends none for a dead organism
  ranges: Range[] = []; // of each gene in its generation; empty: unknown
  ended = false; // its generation has ended
  picks: Picks|null = null;
  origin: Origin = "unknown";
  children: Child[]|null = null; // null: unknown
  parents_bred_elsewhere = false; // before the run began, which is a fork
  children_left_out = false; // the next generation is too large to search it
  #before: OrganismHistory|null;
  #parent_picks: Picks[] = [];
  #descendants_read = 0;
  #found: Child[] = [];

  /** before: of the previous interval, if the organism may be the same. */
  constructor(readonly place: OrganismPlace, before: OrganismHistory|null = null) {
    this.#before = before;
  }

  /** Whether its world has births: the organism has a number and lives on over intervals. */
  get has_births(): boolean {
    return this.info?.number !== undefined;
  }

  /** Whether it lived in the interval before. */
  get is_older(): boolean {
    return this.has_births && this.info?.placed_tick === undefined && distinct_parents(this.info).length > 0;
  }

  get dead(): boolean {
    return this.info !== null && this.info.alive !== true;
  }

  /** Takes an OrganismInfo if it is about this organism: every generation uses the same ids. */
  add_info(info: OrganismInfo): void {
    if (
      (info.id ?? 0) !== this.place.id || (info.generation ?? 0) !== this.place.generation ||
      (info.island ?? 0) !== this.place.island) {
      return;
    }
    this.info = info;
    if (info.brain) {
      this.brain = info.brain;
    }
    if (this.#before?.info?.number === info.number && this.has_births) {
      this.health.push(...this.#before!.health);
    }
    this.#before = null;
    const s = age_of(info);
    const last = this.health[this.health.length - 1];
    if (last && s <= last.s) {
      return;
    }
    if (this.health.length === health_points_max) {
      const kept = this.health.filter((_point, index) => index % 2 === 0);
      this.health.splice(0, this.health.length, ...kept);
    }
    this.health.push({s, health: info.health ?? 0});
  }

  /** Reads the ranges of the genes from the population of the organism's generation. */
  add_population(population: PopulationColumns): void {
    if (
      population.generation !== this.place.generation || population.island !== this.place.island ||
      this.ranges.length > 0) {
      return;
    }
    this.ranges = population.genes.map(range_of);
  }

  /** Returns the fields of the next GetBreeding, without the world; null if nothing is missing.
   *
   *  has_bred  whether the organism's own generation has bred */
  wanted(has_bred: boolean): BreedingRequest|null {
    const {island, generation} = this.place;
    if (this.has_births) {
      return null; // nothing picks parents
    }
    for (const parent of distinct_parents(this.info)) {
      if (!this.picks_of_parent(parent) && !this.parents_bred_elsewhere) {
        return {
          island,
          generation: generation - 1,
          first_contender: parent,
          first_pick: no_rows,
          first_descendant: no_rows
        };
      }
    }
    if (has_bred && (this.picks === null || (this.children === null && !this.children_left_out))) {
      return {
        island,
        generation,
        first_contender: this.picks === null ? this.place.id : no_rows,
        first_pick: no_rows,
        first_descendant: this.#descendants_read,
      };
    }
    return null;
  }

  /** Reads the answer to a request that wanted() returned. */
  add_breeding(request: BreedingRequest, breeding: Breeding): void {
    const generation = breeding.generation ?? 0;
    const contender = breeding.contenders?.[0];
    const picks: Picks|null = contender ? {
      organism: request.first_contender,
      count: contender.copies ?? 0,
      all: breeding.pick_count ?? 0,
      expected: contender.expected_copies ?? 0,
      migrant: contender.migrant ? {island: contender.migrant.island ?? 0, organism: contender.migrant.organism ?? 0} :
                                   null,
    } :
                                          null;
    if (generation === this.place.generation) {
      this.picks = picks ?? this.picks;
      this.#add_descendants(breeding);
    } else if (generation === this.place.generation - 1 && picks) {
      this.origin = this.place.id < (breeding.elite_count ?? 0) ? "elite" :
        this.place.id < (breeding.survivor_count ?? 0)          ? "survivor" :
                                                                  "child";
      this.#parent_picks.push(picks);
    }
  }

  #add_descendants(breeding: Breeding): void {
    const count = breeding.descendant_count ?? 0;
    const rows = breeding.descendants ?? [];
    if (count > offspring_generation_max) {
      this.children_left_out = true;
      return;
    }
    for (const row of rows) {
      const first = row.first_parent ?? 0;
      const second = row.kind === "DESCENDANT_KIND_CHILD" ? row.second_parent ?? 0 : first;
      if (first === this.place.id || second === this.place.id) {
        this.#found.push({
          id: row.id ?? 0,
          other_parent: first === second ? null :
            first === this.place.id      ? second :
                                           first,
          unchanged: first === second && is_copy(row),
        });
      }
    }
    this.#descendants_read += rows.length;
    if (this.#descendants_read >= count) {
      this.children = this.#found;
    } else if (rows.length === 0) {
      this.children_left_out = true; // no answer brings more
    }
  }

  /** Returns the picks of this parent; null until known. */
  picks_of_parent(parent: number): Picks|null {
    return this.#parent_picks.find((picks) => picks.organism === parent) ?? null;
  }
}

/** Whether the descendant has the genes of its parent. */
function is_copy({order_mutation, mutations = []}: Descendant): boolean {
  return !order_mutation && mutations.length === 0;
}

/** Seconds that an organism has lived, of its whole life. */
export function age_of({number, age_s, lived_s}: OrganismInfo): number {
  return (number === undefined ? lived_s : age_s) ?? 0;
}

/** The parents of an organism, each once. */
export function distinct_parents(info: OrganismInfo|null): number[] {
  return [...new Set(info?.parents ?? [])];
}

export function range_of(values: Float32Array): Range {
  let min = Infinity, max = -Infinity, sum = 0;
  for (const value of values) {
    min = Math.min(min, value);
    max = Math.max(max, value);
    sum += value;
  }
  return values.length === 0 ? {min: 0, mean: 0, max: 0} : {min, mean: sum / values.length, max};
}
