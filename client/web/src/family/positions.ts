// Positions: where each organism of a row stands from left to right, in units of the least distance. No DOM.
import type {Spot} from "./spot";

const pass_count = 6;

export function place_evenly(rows: readonly Spot[][], width: number): void {
  for (const row of rows) {
    row.forEach((spot, i) => {
      spot.x = (i + 0.5) / row.length * width;
    });
  }
}

/** Places every organism near its parents and its children, at a distance of at least 1 from its neighbours. */
export function place_near_relatives(rows: readonly Spot[][], width: number): void {
  place_evenly(rows, width);
  const place = (i: number): void => {
    const row = rows[i]!, sums = new Float64Array(row.length), counts = new Uint32Array(row.length);
    for (const child of rows[i + 1] ?? []) {
      for (const parent of [child.first, child.second]) {
        if (parent >= 0) {
          sums[parent]! += child.x;
          counts[parent]! += 1;
        }
      }
    }
    const wanted = row.map((spot, j) => { // the mean of the children counts as much as that of the parents
      const first = rows[i - 1]?.[spot.first]?.x, second = rows[i - 1]?.[spot.second]?.x;
      const near = first === undefined ? spot.x : second === undefined ? first : (first + second) / 2;
      return counts[j] === 0 ? near : (near + sums[j]! / counts[j]!) / 2;
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
