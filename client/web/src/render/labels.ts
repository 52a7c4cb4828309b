// Labels: which organisms have a number, and where it is drawn, so that labels rarely overlap. As in evoview
// (client/viewer/island/labels.cpp, island_renderer.cpp). Lengths are in CSS pixels.
import type {Rectangle} from "./camera";
import type {KeptSnapshot} from "./interpolator";

export interface Label {
  text: string;
  is_named: boolean; // it is drawn on a background
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

/** Places each label above its organism, below it, or next to it, where it overlaps no wall and no earlier label.
 *  Returns the labels that have such a place, and always the first one. `walls`: the part of the screen inside the
 *  walls. */
export function place_labels(labels: Label[], height: number, walls: Rectangle): Label[] {
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
  return labels.filter((label, i) => {
    const {x, y, radius, width} = label;
    const left_most = walls.left + 1, right_most = walls.left + walls.width - width - 1;
    const middle = Math.max(Math.min(x - width / 2, right_most), left_most);
    const places: [left: number, top: number][] = [
      [middle, y - radius - height - 1], [middle, y + radius + 1], [x + radius + 2, y - height / 2],
      [x - radius - 2 - width, y - height / 2]
    ];
    const place = places.find(
      ([left, top]) => left >= left_most && left <= Math.max(right_most, left_most) && top >= walls.top &&
        top + height <= walls.top + walls.height && !collides(left, top, width));
    if (place === undefined && i > 0) {
      return false;
    }
    [label.left, label.top] = place ?? places[0]!;
    const at = key(index(label.top), index(label.left));
    cells.set(at, [...cells.get(at) ?? [], label]);
    return true;
  });
}
