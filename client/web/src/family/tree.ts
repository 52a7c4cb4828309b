// FamilyTree: one organism, or several of one generation, with their ancestors and positions for a drawing: one row per
// generation, the earliest at the top. Organisms without a descendant among the roots are left out. No DOM.
import {type Ancestor, name_key, type OrganismName} from "./lineage";
import type {FamilyTree, Place, Spot} from "./spot";
import {place_evenly, place_near_relatives} from "./positions";
import {order_by_first_parents, order_by_fitness, reduce_crossings} from "./row_order";

export interface TreeForm {
  both_parents: boolean; // false: only lines of first parents, each of which gave at least half of the genes
  generations: number; // the most rows, at least 1
  order: "lines"|"fitness"; // few crossings of lines, or the fittest of each row first
}

/** Builds the tree of organisms of one generation; null if none of them is known. */
export function family_tree(
  ancestors: ReadonlyMap<string, Ancestor>, roots: readonly OrganismName[], form: TreeForm): FamilyTree|null {
  const spot = (ancestor: Ancestor): Spot => ({ancestor, x: 0, first: -1, second: -1});
  const known = roots.map((root) => ancestors.get(name_key(root))).filter((root) => root !== undefined);
  if (known.length === 0) {
    return null;
  }
  const rows: Spot[][] = [known.map((root) => spot(root!))]; // from the roots upwards at first
  while (rows.length < form.generations) {
    const above: Spot[] = [], places = new Map<string, number>();
    const place = (name: OrganismName|undefined): number => {
      const key = name && name_key(name), ancestor = key && ancestors.get(key);
      if (!key || !ancestor) {
        return -1;
      }
      if (!places.has(key)) {
        places.set(key, above.length);
        above.push(spot(ancestor));
      }
      return places.get(key)!;
    };
    for (const child of rows[rows.length - 1]!) {
      child.first = place(child.ancestor.parents[0]);
      child.second = form.both_parents ? place(child.ancestor.parents[1]) : -1;
    }
    if (above.length === 0) {
      break;
    }
    rows.push(above);
  }
  rows.reverse();
  const width = Math.max(...rows.map((row) => row.length));
  if (form.order === "fitness") {
    order_by_fitness(rows);
    place_evenly(rows, width);
  } else {
    order_by_first_parents(rows);
    if (form.both_parents) {
      reduce_crossings(rows);
    }
    place_near_relatives(rows, width);
  }
  return {first_generation: known[0]!.generation - rows.length + 1, rows, width};
}

/** For each organism, the place in the first row of its ancestor along first parents; -1 if that line begins later. */
export function founders_of(tree: FamilyTree): Int32Array[] {
  const founders: Int32Array[] = [];
  tree.rows.forEach((row, i) => {
    founders.push(Int32Array.from(
      row,
      (spot, place) => i === 0 ? place :
        spot.first < 0         ? -1 :
                                 founders[i - 1]![spot.first]!));
  });
  return founders;
}

/** The place of an organism; null if the tree does not contain it. */
export function place_of(tree: FamilyTree, name: OrganismName): Place|null {
  const row = name.generation - tree.first_generation;
  const place = (tree.rows[row] ?? [])
                  .findIndex(({ancestor}) => ancestor.organism === name.organism && ancestor.island === name.island);
  return place < 0 ? null : {row, place};
}

/** The place that an arrow key leads to: up to the first parent (with Shift: the second), down to a child, left and
 *  right in the row, Home and End to the ends of the row. */
export function neighbour(tree: FamilyTree, {row, place}: Place, key: string, shift = false): Place {
  const spots = tree.rows[row]!, at = (other: number): Place => spots[other] ? {row, place: other} : {row, place};
  switch (key) {
    case "ArrowUp": {
      const parent = shift && spots[place]!.second >= 0 ? spots[place]!.second : spots[place]!.first;
      return parent < 0 ? {row, place} : {row: row - 1, place: parent};
    }
    case "ArrowDown": {
      const child = (tree.rows[row + 1] ?? []).findIndex((spot) => spot.first === place || spot.second === place);
      return child < 0 ? {row, place} : {row: row + 1, place: child};
    }
    case "Home":
      return at(0);
    case "End":
      return at(spots.length - 1);
    default:
      return at(place + (key === "ArrowLeft" ? -1 : 1));
  }
}
