// Values and groups of parameters in words, and why a change was refused.
import {rounded, with_separators} from "./numbers";

export const parameter_words = {
  most_used: "Most used",
  on: "on",
  off: "off",
  on_or_off: "on or off",
  range: (min: number, max: number) => `${rounded(min)} to ${rounded(max)}`,
  after_tick: (tick: number) => `after tick ${with_separators(tick)}`,
  in_generation: (generation: number) => `in generation ${with_separators(generation)}`,
  see_marked: "Nothing was changed: see the marked parameters",
  is_stale: "Another client changed parameters at the same time: check the values and apply again",
  lost: "No answer arrived: the change may or may not have been applied",
};
