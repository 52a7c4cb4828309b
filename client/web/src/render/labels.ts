// Labels: which organisms have a number, and where it is drawn, so that labels rarely overlap. As in evoview
// (client/viewer/island/labels.cpp, island_renderer.cpp). Lengths are in CSS pixels.
import type {Rectangle} from "./camera";
import type {KeptSnapshot} from "./interpolator";

export interface Label {
  text: string;
  x: number; // centre of the organism on the screen
  y: number;
  radius: number;
  width: number; // of the text
  left: number; // the upper left corner; set by place_labels()
  top: number;
}

/** Returns the rows of the `count` healthiest organisms, the healthiest first, those with equal health by id. */
export function healthiest(snapshot: KeptSnapshot, count: number): number[] {
  const best: number[] = [];
  const {health} = snapshot;
  for (let i = 0; i < snapshot.count; ++i) {
    if (best.length === count && health[i]! <= health[best[count - 1]!]!) {
      continue;
    }
    let at = best.length;
    while (at > 0 && health[best[at - 1]!]! < health[i]!) {
      --at;
    }
    best.splice(at, 0, i);
    best.length = Math.min(best.length, count);
  }
  return best;
}

/** Places each label above its organism, or below it if it would overlap a wall or an earlier label there. If it
 *  overlaps one at both places, it is above. `walls`: the part of the screen inside the walls. */
export function place_labels(labels: Label[], height: number, walls: Rectangle): void {
  const cell = labels.reduce((most, {width}) => Math.max(most, width), height);
  const cells = new Map<number, Label[]>(); // by the cell of the upper left corner; no label is wider than a cell
  const index = (place: number) => Math.floor(place / cell);
  const key = (row: number, column: number) => row * 100_000 + column;
  const collides = (left: number, top: number, width: number): boolean => {
    for (let row = index(top) - 1; row <= index(top) + 1; ++row) {
      for (let column = index(left) - 1; column <= index(left) + 1; ++column) {
        for (const other of cells.get(key(row, column)) ?? []) {
          if (
            left < other.left + other.width && other.left < left + width && top < other.top + height &&
            other.top < top + height) {
            return true;
          }
        }
      }
    }
    return false;
  };
  for (const label of labels) {
    const right = walls.left + walls.width - label.width - 1;
    const left = Math.max(Math.min(label.x - label.width / 2, right), walls.left + 1);
    const above = label.y - label.radius - height - 1;
    const below = label.y + label.radius + 1;
    const above_is_free = above >= walls.top && !collides(left, above, label.width);
    const below_is_free = below + height <= walls.top + walls.height && !collides(left, below, label.width);
    label.left = left;
    label.top = !above_is_free && (below_is_free || above < walls.top) ? below : above;
    const place = key(index(label.top), index(label.left));
    const there = cells.get(place);
    if (there === undefined) {
      cells.set(place, [label]);
    } else {
      there.push(label);
    }
  }
}
