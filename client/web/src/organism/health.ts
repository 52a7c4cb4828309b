// The axis of the health curve. No DOM.
import {nice_step} from "../render/look";

/** Returns the end of an axis that begins at 0 and contains `most`. */
export function axis_end(most: number): number {
  const step = nice_step(most / 5);
  return step * Math.max(Math.ceil(most / step), 1);
}
