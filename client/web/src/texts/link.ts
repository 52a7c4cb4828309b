// What is wrong with a link to a moment.
import {with_separators} from "./numbers";

export const link_texts = {
  no_number: (field: string, got: string) => `${field}: got "${got}", allowed whole numbers`,
  tick_alone: (got: string) => `tick: got ${got} without a generation, allowed only with a generation`,
  /** "island: got 7, world default has 0 to 3" */
  out_of_range: (field: string, got: string|number, subject: string, first: number, last: number) => `${field}: got ${
    got}, ${subject} has ${first === last ? "only " : `${with_separators(first)} to `}${with_separators(last)}`,
  generation: (generation: number) => `generation ${with_separators(generation)}`,
  run: "the run",
};
