// curve: a curve that a user draws over an axis: a value at each of equally spaced places. Pure.
import type {CurveQuestion, Point} from "./lesson_file";

const intervals = 30; // between the places
export const field_count = 6; // places that have a number field
const field_step = intervals / (field_count - 1);

function rounded(value: number): number {
  return Number(value.toPrecision(6));
}

export class DrawnCurve {
  readonly #values: (number|null)[] = new Array<number|null>(intervals + 1).fill(null);
  #last: number|null = null; // the place that the pointer has drawn last

  constructor(readonly question: CurveQuestion) {}

  /** The points that are drawn, x ascending. */
  get points(): Point[] {
    return this.#values.flatMap((y, i): Point[] => (y === null ? [] : [[rounded(this.#x(i)), rounded(y)]]));
  }

  /** The place and the value of a number field. */
  field(i: number): {x: number; y: number | null} {
    const place = i * field_step;
    return {x: rounded(this.#x(place)), y: this.#values[place] ?? null};
  }

  /** Sets the value of a field. The curve is then straight up to the next fields that have values. */
  set_field(i: number, y: number|null): void {
    const place = i * field_step;
    this.#values[place] = y === null ? null : this.#within(y);
    for (const other of [place - field_step, place + field_step]) {
      if (other >= 0 && other <= intervals) {
        this.#connect(place, other);
      }
    }
  }

  /** The pointer draws at a point of the plot. begins: it was not pressed before */
  draw(x: number, y: number, begins: boolean): void {
    const {min, max} = this.question.x;
    const place = Math.min(Math.max(Math.round((x - min) / (max - min) * intervals), 0), intervals);
    this.#values[place] = this.#within(y);
    if (!begins && this.#last !== null) {
      this.#connect(this.#last, place);
    }
    this.#last = place;
  }

  /** Shows these points in the place of what was drawn. */
  show(points: readonly Point[]): void {
    this.#values.forEach((_, i) => (this.#values[i] = value_at(points, this.#x(i))));
  }

  clear(): void {
    this.#values.fill(null);
  }

  #x(place: number): number {
    const {min, max} = this.question.x;
    return min + (max - min) * place / intervals;
  }

  #within(y: number): number {
    return Math.min(Math.max(y, this.question.y.min), this.question.y.max);
  }

  /** Makes the curve straight between two places, or removes it if one of them has no value. */
  #connect(one: number, other: number): void {
    const from = Math.min(one, other), to = Math.max(one, other), first = this.#values[from] ?? null;
    const last = this.#values[to] ?? null;
    for (let i = from + 1; i < to; ++i) {
      this.#values[i] = first === null || last === null ? null : first + (last - first) * (i - from) / (to - from);
    }
  }
}

/** The value of a curve that is straight between its points, and constant beyond them. */
export function value_at(points: readonly Point[], x: number): number {
  const next = points.findIndex(([at]) => at >= x);
  if (next === -1) {
    return points.at(-1)![1];
  }
  const [x1, y1] = points[next]!;
  if (next === 0 || x1 === x) {
    return y1;
  }
  const [x0, y0] = points[next - 1]!;
  return y0 + (y1 - y0) * (x - x0) / (x1 - x0);
}
