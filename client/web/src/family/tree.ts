// FamilyTree: the ancestors of one organism with positions for a drawing: one row per generation, the earliest at the
// top. The children of an organism are adjacent and ordered as their parents, so lines of first parents never cross. No
// DOM.
import {three_digits, with_separators} from "../texts/numbers";
import {type Ancestor, name_key, type OrganismName} from "./lineage";

export interface Spot {
  ancestor: Ancestor;
  x: number; // from 0 to FamilyTree.width
  first: number; // places of the parents in the row above; -1: unknown, or not in the tree
  second: number;
  child_count: number; // children in the tree of which it is the first parent
}

export interface FamilyTree {
  first_generation: number; // of the first row
  rows: Spot[][]; // ordered by x
  width: number;
}

/** Builds the tree of `root`.
 *
 *  both_parents  false: only lines of first parents, each of which gave at least half of the genes
 *  generations   the most rows, at least 1 */
export function family_tree(
  ancestors: ReadonlyMap<string, Ancestor>, root: OrganismName, both_parents: boolean, generations: number): FamilyTree|
  null {
  const self = ancestors.get(name_key(root));
  if (!self) {
    return null;
  }
  const spot = (ancestor: Ancestor): Spot => ({ancestor, x: 0, first: -1, second: -1, child_count: 0});
  const rows: Spot[][] = [[spot(self)]]; // from the root upwards at first
  while (rows.length < generations) {
    const above: Spot[] = [], places = new Map<string, number>();
    const place = (name: OrganismName|undefined): number => {
      const ancestor = name && ancestors.get(name_key(name));
      if (!ancestor) {
        return -1;
      }
      const key = name_key(ancestor);
      if (!places.has(key)) {
        places.set(key, above.length);
        above.push(spot(ancestor));
      }
      return places.get(key)!;
    };
    for (const child of rows[rows.length - 1]!) {
      child.first = place(child.ancestor.parents[0]);
      child.second = both_parents ? place(child.ancestor.parents[1]) : -1;
      if (child.first >= 0) {
        above[child.first]!.child_count += 1;
      }
    }
    if (above.length === 0) {
      break;
    }
    rows.push(above);
  }
  rows.reverse();
  order(rows);
  const width = Math.max(...rows.map((row) => row.length));
  place_near_relatives(rows, width);
  return {first_generation: root.generation - rows.length + 1, rows, width};
}

/** Orders every row, from the earliest one on, by first parent, second parent, island and id. */
function order(rows: Spot[][]): void {
  rows.forEach((row, i) => {
    const places =
      row.map((_, place) => place)
        .sort(
          (a, b) => row[a]!.first - row[b]!.first || row[a]!.second - row[b]!.second ||
            row[a]!.ancestor.island - row[b]!.ancestor.island || row[a]!.ancestor.organism - row[b]!.ancestor.organism);
    const moved: number[] = [];
    places.forEach((old, place) => {
      moved[old] = place;
    });
    rows[i] = places.map((old) => row[old]!);
    for (const child of rows[i + 1] ?? []) {
      child.first = child.first < 0 ? -1 : moved[child.first]!;
      child.second = child.second < 0 ? -1 : moved[child.second]!;
    }
  });
}

const pass_count = 6;

/** Places every organism near its first parent and its children, at a distance of at least 1 from its neighbours. */
function place_near_relatives(rows: Spot[][], width: number): void {
  for (const row of rows) {
    row.forEach((spot, i) => {
      spot.x = (i + 0.5) / row.length * width;
    });
  }
  const place = (i: number): void => {
    const row = rows[i]!, of_children = row.map(() => 0);
    for (const child of rows[i + 1] ?? []) {
      if (child.first >= 0) {
        of_children[child.first]! += child.x / row[child.first]!.child_count;
      }
    }
    const wanted = row.map((spot, j) => { // the mean of the children counts as much as the parent
      const near = spot.first < 0 ? spot.x : rows[i - 1]![spot.first]!.x;
      return spot.child_count === 0 ? near : (near + of_children[j]!) / 2;
    });
    spread(wanted, width).forEach((x, j) => {
      row[j]!.x = x;
    });
  };
  for (let pass = 0; pass < pass_count; ++pass) {
    for (let i = rows.length - 1; i >= 0; --i) {
      place(i);
    }
    for (let i = 0; i < rows.length; ++i) {
      place(i);
    }
  }
}

/** Moves the positions as little as possible (least squares), so that they rise by at least 1 from one to the next, and
 *  lie at least 0.5 inside 0 to `width`, which is at least their number. Source: pool adjacent violators, Ayer et al.
 *  1955, doi:10.1214/aoms/1177728423. */
export function spread(positions: readonly number[], width: number): number[] {
  const blocks: {sum: number; count: number}[] = []; // of neighbours at a distance of exactly 1
  positions.forEach((x, i) => {
    blocks.push({sum: x - i, count: 1});
    while (blocks.length > 1) {
      const last = blocks[blocks.length - 1]!, before = blocks[blocks.length - 2]!;
      if (before.sum / before.count < last.sum / last.count) {
        break;
      }
      before.sum += last.sum;
      before.count += last.count;
      blocks.pop();
    }
  });
  const most = width - positions.length + 0.5;
  return blocks
    .flatMap((block) => new Array<number>(block.count).fill(Math.min(Math.max(block.sum / block.count, 0.5), most)))
    .map((x, i) => x + i);
}

/** "Organism 45 of generation 4: a child of 3 and 7, fitness 123; 2 children and 1 copy in the next generation." */
export function ancestor_text(ancestor: Ancestor): string {
  const {generation, island, organism, parents, child_count, kept_count} = ancestor;
  const named = parents
                  .map(
                    (parent) => parent.island === island ? String(parent.organism) :
                                                           `${parent.organism} of island ${parent.island}`)
                  .join(" and ");
  const kind = parents.length === 0 ? (ancestor.origin === "placed" ? "placed by a user" : "without known parents") :
    ancestor.origin === "elite"     ? `of the elite, a copy of ${named}` :
        ancestor.origin === "survivor" ? `a survivor, a copy of ${named}` :
                                         `a child of ${named}`;
  const next =
    [
      child_count > 0 ? `${with_separators(child_count)} ${child_count === 1 ? "child" : "children"}` : "",
      kept_count > 0 ? `${with_separators(kept_count)} ${kept_count === 1 ? "copy" : "copies"}` : "",
    ].filter((part) => part !== "")
      .join(" and ");
  return `Organism ${organism} of generation ` +
    `${with_separators(generation)}${island > 0 ? `, island ${island}` : ""}: ${kind}` +
    (ancestor.fitness === null ? "" : `, fitness ${three_digits(ancestor.fitness)}`) +
    (next ? `; ${next} in the next generation` : "") + ".";
}

/** The place that an arrow key leads to: up to the first parent, down to a child, left and right in the row. */
export function neighbour(tree: FamilyTree, row: number, place: number, key: string): {row: number; place: number} {
  const here = {row, place};
  if (key === "ArrowUp") {
    const first = tree.rows[row]![place]!.first;
    return first < 0 ? here : {row: row - 1, place: first};
  }
  if (key === "ArrowDown") {
    const child = (tree.rows[row + 1] ?? []).findIndex((spot) => spot.first === place || spot.second === place);
    return child < 0 ? here : {row: row + 1, place: child};
  }
  const next = place + (key === "ArrowLeft" ? -1 : 1);
  return tree.rows[row]![next] ? {row, place: next} : here;
}
