// Picker: asks the worker what is drawn at a point of the canvas.
import type {FromWorker, ToWorker} from "../core/messages";
import type {Point} from "../render/camera";

export type Picked = Extract<FromWorker, {kind: "picked"}>;

const target_pixels = 12;
const picks_per_pane = 1_000_000; // so that each answer has its own number

export class Picker {
  readonly #pane: number;
  readonly #post: (message: ToWorker) => void;
  readonly #waiting = new Map<number, (picked: Picked) => void>();
  #last = 0;

  constructor(pane: number, post: (message: ToWorker) => void) {
    this.#pane = pane;
    this.#post = post;
  }

  what_is_at({x, y}: Point): Promise<Picked> {
    const id = this.#pane * picks_per_pane + ++this.#last;
    return new Promise((resolve) => {
      this.#waiting.set(id, resolve);
      this.#post({kind: "pick", pane: this.#pane, id, x, y, radius: target_pixels});
    });
  }

  take(message: FromWorker): void {
    if (message.kind === "picked") {
      this.#waiting.get(message.id)?.(message);
      this.#waiting.delete(message.id);
    }
  }
}
