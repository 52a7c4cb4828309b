// Row order: which organism of a generation is drawn left of which. Orders change the rows in place, and the places of
// parents with them. No DOM.
import type {Spot} from "./spot";

const sweeps_max = 12;
const sweeps_without_gain_max = 3;

/** Puts the spots of row i in this order of their present places. */
function permute(rows: Spot[][], i: number, order: readonly number[]): void {
  const moved: number[] = [];
  order.forEach((old, place) => {
    moved[old] = place;
  });
  rows[i] = order.map((old) => rows[i]![old]!);
  for (const child of rows[i + 1] ?? []) {
    child.first = child.first < 0 ? -1 : moved[child.first]!;
    child.second = child.second < 0 ? -1 : moved[child.second]!;
  }
}

function sort_rows(rows: Spot[][], compare: (a: Spot, b: Spot) => number): void {
  for (let i = 0; i < rows.length; ++i) {
    const row = rows[i]!;
    permute(
      rows, i,
      row.map((_, place) => place)
        .sort(
          (a, b) => compare(row[a]!, row[b]!) || row[a]!.ancestor.island - row[b]!.ancestor.island ||
            row[a]!.ancestor.organism - row[b]!.ancestor.organism));
  }
}

/** Orders every row, from the earliest one on, by first parent, second parent, island and id: children of an organism
 *  are adjacent and ordered as their parents, so lines of first parents never cross. */
export function order_by_first_parents(rows: Spot[][]): void {
  sort_rows(rows, (a, b) => a.first - b.first || a.second - b.second);
}

/** The fittest first; organisms without a fitness last; among equal ones the lower id. */
export function order_by_fitness(rows: Spot[][]): void {
  const fitness = ({ancestor}: Spot): number => ancestor.fitness ?? -Infinity;
  sort_rows(rows, (a, b) => (fitness(a) === fitness(b) ? 0 : fitness(b) - fitness(a)));
}

/** How many pairs of lines between two neighbouring rows cross.
 *
 *  ranks  of each place of each row, from the left; absent: the places */
export function crossing_count(rows: readonly Spot[][], ranks?: readonly number[][]): number {
  let count = 0;
  for (let i = 1; i < rows.length; ++i) {
    count += crossings_below(rows[i - 1]!.length, rows[i]!, ranks?.[i - 1], ranks?.[i]);
  }
  return count;
}

/** Counts the crossings of the lines from a row to the row above, which has `above` organisms. */
function crossings_below(
  above: number, row: readonly Spot[], ranks_above: readonly number[]|undefined,
  ranks: readonly number[]|undefined): number {
  // The lower ends of all lines, grouped by their upper end from left to right.
  const begins = new Uint32Array(above + 1), lower_ends = new Uint32Array(2 * row.length);
  const each = (visit: (upper: number, lower: number) => void): void => row.forEach((spot, place) => {
    for (const parent of [spot.first, spot.second]) {
      if (parent >= 0) {
        visit(ranks_above?.[parent] ?? parent, ranks?.[place] ?? place);
      }
    }
  });
  each((upper) => {
    begins[upper + 1]! += 1;
  });
  for (let upper = 0; upper < above; ++upper) {
    begins[upper + 1]! += begins[upper]!;
  }
  const next = begins.slice();
  each((upper, lower) => {
    lower_ends[next[upper]!++] = lower;
  });
  const sums = new Uint32Array(row.length + 1); // Fenwick tree: the lines from further left, by their lower end
  let count = 0;
  for (let upper = 0; upper < above; ++upper) {
    for (let line = begins[upper]!; line < begins[upper + 1]!; ++line) {
      count += begins[upper]!;
      for (let at = lower_ends[line]! + 1; at > 0; at -= at & -at) {
        count -= sums[at]!;
      }
    }
    for (let line = begins[upper]!; line < begins[upper + 1]!; ++line) {
      for (let at = lower_ends[line]! + 1; at < sums.length; at += at & -at) {
        sums[at]! += 1;
      }
    }
  }
  return count;
}

/** Reduces the crossings: places each organism at the mean place of its children, then of its parents, in turn, and
 *  keeps the order with the fewest crossings. Source: barycentre method, Sugiyama, Tagawa & Toda 1981, "Methods for
 *  visual understanding of hierarchical system structures", doi:10.1109/TSMC.1981.4308636. */
export function reduce_crossings(rows: Spot[][]): void {
  const ranks = rows.map((row) => row.map((_, place) => place));
  let best = ranks.map((rank) => [...rank]), least = crossing_count(rows), without_gain = 0;
  for (let sweep = 0; sweep < sweeps_max && least > 0 && without_gain < sweeps_without_gain_max; ++sweep) {
    if (sweep % 2 === 0) {
      for (let i = rows.length - 2; i >= 0; --i) {
        rank_by(ranks[i]!, means_of_children(rows, ranks, i));
      }
    } else {
      for (let i = 1; i < rows.length; ++i) {
        rank_by(ranks[i]!, means_of_parents(rows, ranks, i));
      }
    }
    const count = crossing_count(rows, ranks);
    without_gain = count < least ? 0 : without_gain + 1;
    if (count < least) {
      least = count;
      best = ranks.map((rank) => [...rank]);
    }
  }
  best.forEach((rank, i) => {
    const order: number[] = [];
    rank.forEach((to, place) => {
      order[to] = place;
    });
    permute(rows, i, order);
  });
}

/** Ranks the places of a row by these numbers; equal ones keep their order. */
function rank_by(rank: number[], wanted: readonly number[]): void {
  const order = rank.map((_, place) => place).sort((a, b) => wanted[a]! - wanted[b]! || rank[a]! - rank[b]!);
  order.forEach((place, to) => {
    rank[place] = to;
  });
}

/** The mean rank of the parents, 0 to 1; its own rank for an organism without parents. */
function means_of_parents(rows: readonly Spot[][], ranks: readonly number[][], i: number): number[] {
  const above = ranks[i - 1]!, length = above.length, own = ranks[i]!;
  return rows[i]!.map((spot, place) => {
    const known = [spot.first, spot.second].filter((parent) => parent >= 0);
    return known.length === 0 ? own[place]! / own.length :
                                known.reduce((sum, parent) => sum + above[parent]!, 0) / known.length / length;
  });
}

function means_of_children(rows: readonly Spot[][], ranks: readonly number[][], i: number): number[] {
  const below = ranks[i + 1]!, own = ranks[i]!;
  const sums = new Float64Array(own.length), counts = new Uint32Array(own.length);
  rows[i + 1]!.forEach((child, place) => {
    for (const parent of [child.first, child.second]) {
      if (parent >= 0) {
        sums[parent]! += below[place]! / below.length;
        counts[parent]! += 1;
      }
    }
  });
  return own.map((rank, place) => counts[place]! > 0 ? sums[place]! / counts[place]! : rank / own.length);
}
