// Common ancestors: from which organisms of a tree all its roots descend, and from which two organisms descend. Along
// both parents, or in a tree of first parents along these. No DOM.
//
// Source  Chang 1999, "Recent common ancestors of all present-day individuals", doi:10.1239/aap/1029955256; in a tree
//         of first parents the lines coalesce: Kingman 1982, "The coalescent", doi:10.1016/0304-4149(82)90011-4.
import type {FamilyTree, Place, Spot} from "./spot";

export interface CommonAncestors {
  row: number; // the latest with a common ancestor
  places: number[]; // of the common ancestors in that row
}

/** all_row  the latest row of which every organism is an ancestor of all roots; null if there is none */
export interface AncestorsOfAll extends CommonAncestors {
  all_row: number|null;
}

function parents_of(spot: Spot): number[] {
  return spot.first < 0 ? [] : spot.second < 0 ? [spot.first] : [spot.first, spot.second];
}

/** Returns the most recent common ancestors of all roots; null if the tree has one root, or contains none. */
export function ancestors_of_all(tree: FamilyTree): AncestorsOfAll|null {
  const root_count = tree.rows[tree.rows.length - 1]!.length, words = Math.ceil(root_count / 32);
  if (root_count < 2) {
    return null;
  }
  let below = new Uint32Array(root_count * words); // `words` per organism, one bit per root
  for (let root = 0; root < root_count; ++root) {
    below[root * words + (root >>> 5)]! |= 1 << (root & 31);
  }
  const full = new Uint32Array(words).fill(0xffffffff);
  full[words - 1] = root_count % 32 === 0 ? 0xffffffff : 2 ** (root_count % 32) - 1;
  let found: CommonAncestors|null = null;
  for (let i = tree.rows.length - 1; i > 0; --i) {
    const count = tree.rows[i - 1]!.length, above = new Uint32Array(count * words);
    tree.rows[i]!.forEach((spot, child) => {
      for (const parent of parents_of(spot)) {
        for (let word = 0; word < words; ++word) {
          above[parent * words + word]! |= below[child * words + word]!;
        }
      }
    });
    const places = tree.rows[i - 1]!.flatMap(
      (_, place) => full.every((bits, word) => above[place * words + word] === bits) ? [place] : []);
    if (places.length > 0) {
      found ??= {row: i - 1, places};
    }
    if (places.length === count) {
      return {...found!, all_row: i - 1};
    }
    below = above;
  }
  return found && {...found, all_row: null};
}

export interface AncestorsOfTwo extends CommonAncestors {
  between: Set<Spot>; // the organisms on all lines from the common ancestors to the two, with both ends
}

/** Returns the most recent common ancestors of two organisms, one of which may be an ancestor of the other; null if the
 *  tree contains none. */
export function ancestors_of_two(tree: FamilyTree, one: Place, other: Place): AncestorsOfTwo|null {
  const marks = tree.rows.map((row) => new Uint8Array(row.length)); // 1: of the one, 2: of the other, 3: of both
  marks[one.row]![one.place]! |= 1;
  marks[other.row]![other.place]! |= 2;
  for (let i = Math.max(one.row, other.row); i >= 0; --i) {
    const places = [...marks[i]!.keys()].filter((place) => marks[i]![place] === 3);
    if (places.length > 0) {
      return {row: i, places, between: between(tree, marks, i, places)};
    }
    tree.rows[i]!.forEach((spot, place) => {
      for (const parent of parents_of(spot)) {
        marks[i - 1]![parent]! |= marks[i]![place]!;
      }
    });
  }
  return null;
}

function between(tree: FamilyTree, marks: readonly Uint8Array[], top: number, places: readonly number[]): Set<Spot> {
  const spots = new Set(places.map((place) => tree.rows[top]![place]!));
  for (let i = top + 1; i < tree.rows.length; ++i) {
    tree.rows[i]!.forEach((spot, place) => {
      if (marks[i]![place] !== 0 && parents_of(spot).some((parent) => spots.has(tree.rows[i - 1]![parent]!))) {
        spots.add(spot);
      }
    });
  }
  return spots;
}
