// Texts of the time line.
import {with_separators} from "./numbers";

export const timeline_texts = {
  generation: "generation",
  generation_help: (first: number, last: number) =>
    `Type a generation from ${with_separators(first)} to ${with_separators(last)}, and press Enter to show it.`,
};
