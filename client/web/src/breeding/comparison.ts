// Comparison: for each rank, the observed number of copies next to the number that the law of the selection method
// expects. No DOM.
import {type BreedingRecord, rank_of} from "./record";

/** Each list is indexed by rank and has one entry per contender. */
export interface Comparison {
  organisms: number[]; // id of the organism with this rank
  fitness: number[];
  copies: number[]; // observed in all picks
  expected: number[];
  standard_error: number[]; // of the copies over repetitions of the breeding
  unpicked_chance: number[]; // probability of having no copy
  deviations: number[]; // of the observed from the expected copies, in standard errors
  beyond_two: number; // ranks whose copies deviate by more than two standard errors
}

/** Compares the observed copies with the expected ones. Returns null until the server has sent every contender. */
export function compare(record: BreedingRecord): Comparison|null {
  const count = record.contender_count;
  if (count === 0 || record.contenders.length !== count) {
    return null;
  }
  const by_rank = new Array<number>(count).fill(-1);
  record.contenders.forEach((contender, organism) => {
    by_rank[rank_of(contender)] = organism;
  });
  if (by_rank.length !== count || by_rank.includes(-1)) {
    return null;
  }
  const column = (field: "fitness"|"copies"|"expected_copies"|"expected_copies_error"|"unpicked_chance"): number[] =>
    by_rank.map((organism) => record.contenders[organism]![field] ?? 0);
  const copies = column("copies"), expected = column("expected_copies"),
        standard_error = column("expected_copies_error");
  const deviations = copies.map((observed, rank) => deviation(observed, expected[rank]!, standard_error[rank]!));
  return {
    organisms: by_rank,
    fitness: column("fitness"),
    copies,
    expected,
    standard_error,
    unpicked_chance: column("unpicked_chance"),
    deviations,
    beyond_two: deviations.filter((off) => Math.abs(off) > 2).length,
  };
}

/** (observed − expected) / standard error; 0 if both numbers differ only by rounding. */
export function deviation(observed: number, expected: number, standard_error: number): number {
  const difference = observed - expected;
  if (Math.abs(difference) <= 1e-9 * Math.max(Math.abs(expected), 1)) {
    return 0;
  }
  return standard_error > 0 ? difference / standard_error : Math.sign(difference) * Infinity;
}

/** For each rank, the number of the first `count` picks that selected it. Ignores rows that have not been received. */
export function copies_after(record: BreedingRecord, count: number): number[] {
  const copies = new Array<number>(record.contender_count).fill(0);
  for (const pick of record.picks.slice(0, count)) {
    const contender = record.contenders[pick.organism ?? 0];
    if (contender) {
      copies[rank_of(contender)] += 1;
    }
  }
  return copies;
}

/** Divides `count` neighbours, numbered from 0, into at most `most` groups, whose sizes differ by at most one. */
export function divided(count: number, most: number): {first: number; last: number}[] {
  const groups = Math.min(count, most), begin = (group: number): number => Math.floor(group * count / groups);
  return Array.from({length: groups}, (_, group) => ({first: begin(group), last: begin(group + 1) - 1}));
}

/** A group of neighbouring ranks that is drawn as one bar. */
export interface RankColumn {
  first: number; // ranks
  last: number;
  copies: number; // sums over the ranks
  expected: number;
  standard_error: number; // ranks in a group are treated as independent
  deviation: number; // after all picks, in standard errors
}

/** Distributes the ranks over at most `columns` groups.
 *
 *  copies          observed copies by rank
 *  expected_share  factor for the expected copies: the fraction of all picks that `copies` includes, 0 to 1 */
export function rank_columns(
  comparison: Comparison, copies: readonly number[], expected_share: number, columns: number): RankColumn[] {
  return divided(copies.length, columns).map((ranks) => {
    const column = {...ranks, copies: 0, expected: 0, standard_error: 0, deviation: 0};
    let all_copies = 0, all_expected = 0, variance = 0;
    for (let rank = column.first; rank <= column.last; ++rank) {
      column.copies += copies[rank]!;
      all_copies += comparison.copies[rank]!;
      all_expected += comparison.expected[rank]!;
      variance += comparison.standard_error[rank]! ** 2;
    }
    column.expected = all_expected * expected_share;
    column.standard_error = Math.sqrt(variance * expected_share);
    column.deviation = deviation(all_copies, all_expected, Math.sqrt(variance));
    return column;
  });
}

/** A group of consecutive picks that is drawn as one cell. */
export interface PickColumn {
  first: number; // picks
  last: number;
  rank: number|null; // mean rank of the picks made; null if none was made or received
}

/** Distributes all picks, in order, over at most `columns` groups. Ignores the ranks of picks after `index`. */
export function pick_columns(record: BreedingRecord, index: number, columns: number): PickColumn[] {
  return divided(record.pick_count, columns).map(({first, last}) => {
    const ranks = record.picks.slice(first, Math.min(last, index) + 1)
                    .map((pick) => record.contenders[pick.organism ?? 0])
                    .flatMap((contender) => (contender ? [rank_of(contender)] : []));
    return {first, last, rank: ranks.length > 0 ? ranks.reduce((sum, rank) => sum + rank, 0) / ranks.length : null};
  });
}
