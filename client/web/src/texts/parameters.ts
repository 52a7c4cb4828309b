// Texts of the panel "Parameters".
import type {ParameterEffect} from "../core/protocol";

import {capitalised, with_separators} from "./numbers";

const counted = (count: number, one: string, many: string): string =>
  `${with_separators(count)} ${count === 1 ? one : many}`;

/** Warnings of the server, each on a line. */
export function warning_text(warnings: readonly string[]): string {
  return warnings.map((warning) => `${capitalised(warning)}.`).join("\n");
}

/** When a change takes effect: a word for the row, and a sentence. */
export const effect_texts: {readonly[effect in ParameterEffect]?: {word: string; sentence: string}} = {
  PARAMETER_EFFECT_NEXT_TICK:
    {word: "now", sentence: "Takes effect at the next tick; breeding parameters, at the next breeding."},
  PARAMETER_EFFECT_NEXT_GENERATION: {word: "next gen.", sentence: "Takes effect with the next generation."},
  PARAMETER_EFFECT_RESET: {word: "reset", sentence: "Takes effect when the world is reset."},
};

export const parameters_texts = {
  apply: "Apply",
  plan: "Plan",
  discard: "Discard",
  discard_help: "Removes all edits.",
  at_once: "apply at once",
  at_once_help: "Applies each change as soon as you make it.",
  search: "Search parameters",
  search_hint: "search in names, groups and descriptions",
  nothing_found: "No parameter matches.",
  typing_is_wrong: "Nothing was sent: see the marked parameter.",
  no_edits: "There are no edits.",
  plan_help: "Sends all edits as one change, which the server applies later.",
  apply_help: "Sends all edits as one change: the server accepts all of them or none.",
  loading: "Loading the parameters …",
  sending: "Sending …",
  revision: (revision: number) => `Revision ${with_separators(revision)}; no edits`,
  edits: (count: number) => `${counted(count, "edit", "edits")} not applied yet`,
  planned: (count: number, when: string) => `Planned ${counted(count, "change", "changes")} ${when}.`,
  applied: (count: number, tick: number) =>
    `Applied ${counted(count, "change", "changes")} from tick ${with_separators(tick)}.`,
};

export const when_texts = {
  choice: "When the edits are applied",
  now: "now",
  in_generation: "in generation",
  after_tick: "after tick",
  number: "generation or tick",
  wrong: (kind: string, got: string) => `${kind}: got "${got}", allowed whole numbers from 1`,
};

export const planned_texts = {
  title: (count: number) => `Planned changes (${with_separators(count)})`,
  change: (when: string, values: string[], by: string) => `${when}: ${values.join(", ")} by ${by}`,
  scheduled: (generation: number, value: string) =>
    `in generation ${with_separators(generation)}: ${value} by the schedule`,
};

export const parameter_texts = {
  not_default: "This is not the default value.",
  to_default: "default",
  to_default_help: (value: string) => `Default: ${value}`,
  to_default_name: (parameter: string, value: string) => `Set ${parameter} to its default ${value}`,
  was: (value: string) => `was ${value}`,
  still: (value: string) => `still ${value}`,
  set_by: (client: string) => `set by ${client}`,
  planned: (values: string[]) =>
    `planned: ${values[0]}${values.length > 1 ? ` and ${with_separators(values.length - 1)} more` : ""}`,
  refused: (got: string, allowed: string) => `${got === "" ? "" : `got ${got}, `}allowed ${allowed}`,
  wrong_text: (got: string, is_whole: boolean, allowed: string) =>
    `got "${got}", allowed ${is_whole ? "whole numbers from " : ""}${allowed}`,
  now_and_then: (now: string, later: string) => `${now}, then ${later}`,
  facts: (allowed: string, usual: string, now: string) => `Allowed: ${allowed}. Default: ${usual}. Now: ${now}.`,
};
