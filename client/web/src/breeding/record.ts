// BreedingRecord: how one generation was bred, merged from the pages that the server has sent so far. No DOM.
import type {Breeding, Contender, Descendant, GetBreeding, ParameterValue, Pick} from "../core/protocol";
import type {Moment} from "./stepper";

export const rows_kept_max = 20_000; // of each list
const rows_ahead = 64; // requested beyond the row shown, so that playing does not wait for the server

export interface BreedingKey {
  world: string;
  run_id: string;
  island: number;
  generation: number; // of the parents
}

export function same_key(a: BreedingKey, b: BreedingKey): boolean {
  return a.world === b.world && a.run_id === b.run_id && a.island === b.island && a.generation === b.generation;
}

export class BreedingRecord {
  /** Breeding without its lists; null before the first page. */
  head: Omit<Breeding, "contenders"|"picks"|"descendants">|null = null;
  /** The rows received so far, from row 0. */
  readonly contenders: Contender[] = [];
  readonly picks: Pick[] = [];
  readonly descendants: Descendant[] = [];
  #no_new_row = false; // the last page contained no new row

  constructor(readonly key: BreedingKey) {}

  get contender_count(): number {
    return this.head?.contender_count ?? 0;
  }

  /** The picks that the user can step through. */
  get pick_count(): number {
    return Math.min(this.head?.pick_count ?? 0, rows_kept_max);
  }

  get descendant_count(): number {
    return Math.min(this.head?.descendant_count ?? 0, rows_kept_max);
  }

  get elite_count(): number {
    return this.head?.elite_count ?? 0;
  }

  get survivor_count(): number {
    return this.head?.survivor_count ?? 0;
  }

  /** Returns the fields of the next GetBreeding that is needed to show `moment`. Returns null if no data is missing, or
   *  if the last answer contained no new row. */
  wanted(moment: Moment): GetBreeding|null {
    const fields: GetBreeding = {world: this.key.world, island: this.key.island, generation: this.key.generation};
    if (!this.head) {
      return fields;
    }
    if (this.#no_new_row) {
      return null;
    }
    let any = false;
    // A request always names a first row for every list. To receive no rows of a list, it names the end of that list.
    const first_of = (have: number, shown: number, count: number): number => {
      if (have >= Math.min(shown, count, rows_kept_max)) {
        return count;
      }
      any = true;
      return have;
    };
    const {contender_count = 0, pick_count = 0, descendant_count = 0} = this.head;
    fields.first_contender = first_of(this.contenders.length, contender_count, contender_count);
    fields.first_pick =
      first_of(this.picks.length, moment.stage === "picking" ? moment.index + rows_ahead : 0, pick_count);
    fields.first_descendant =
      first_of(this.descendants.length, moment.stage === "breeding" ? moment.index + rows_ahead : 0, descendant_count);
    return any ? fields : null;
  }

  /** Adds the answer to the request from wanted(). Returns whether it is about this generation and island. */
  add(page: Breeding): boolean {
    if ((page.generation ?? 0) !== this.key.generation || (page.island ?? 0) !== this.key.island) {
      return false;
    }
    if (!this.head) {
      const {contenders: _contenders, picks: _picks, descendants: _descendants, ...head} = page;
      this.head = head;
    }
    const append = <Row>(have: Row[], rows: Row[]|undefined, count: number): boolean => {
      const added = (rows ?? []).slice(0, Math.max(0, Math.min(count, rows_kept_max) - have.length));
      have.push(...added);
      return added.length > 0;
    };
    const added = [
      append(this.contenders, page.contenders, this.contender_count),
      append(this.picks, page.picks, this.head.pick_count ?? 0),
      append(this.descendants, page.descendants, this.head.descendant_count ?? 0),
    ];
    this.#no_new_row = !added.includes(true);
    return true;
  }

  /** The value of a parameter with named choices, such as "roulette"; "" if the server did not send the parameter. */
  choice(name: string): string {
    return this.#parameter(name)?.choice ?? "";
  }

  /** The value of a real or whole-number parameter; a flag is 0 or 1. */
  number(name: string): number|null {
    const value = this.#parameter(name);
    return !value ? null : value.real ?? value.count ?? (value.flag === undefined ? null : value.flag ? 1 : 0);
  }

  #parameter(name: string): ParameterValue|null {
    return this.head?.parameters?.find((parameter) => parameter.name === name)?.value ?? null;
  }
}

/** Organism ids, ranks and numbers that are 0 are absent in messages. */
export function rank_of(contender: Contender): number {
  return contender.rank ?? 0;
}

/** The share of the wheel that the organism's slot has, 0 to 1. */
export function slot_of(contender: Contender): number {
  return (contender.slot_end ?? 0) - (contender.slot_begin ?? 0);
}
