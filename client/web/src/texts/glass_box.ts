// Texts of the panel "Glass box": its controls and drawings. What it says about a breeding is in breeding.ts.
import {counted} from "./breeding";
import {fitness_text, three_digits, with_separators, with_sign} from "./numbers";

/** A number of standard errors; infinite if the expected number does not vary. */
function off_text(off: number): string {
  return Number.isFinite(off) ? with_sign(off) : off > 0 ? "∞" : "−∞";
}

export const glass_box_texts = {
  title: "Glass box",
  wrong_generation: (generation: number): string =>
    `The server sent the breeding of a generation other than ${with_separators(generation)}`,
  not_picked: (organism: number, generation: number): string =>
    `Organism ${organism} was not picked when generation ${with_separators(generation)} bred.`,
  summary: (world: string, generation: number, breeding: string): string =>
    `World ${world}, generation ${with_separators(generation)}: ${breeding}`,
  problem: (problem: string): string => `${problem}.`,
  retry: "Retry",
  no_snapshot: "Waiting for the first snapshot …",
  births: "In this world no generation is bred: organisms have children while they live. The panel “Organism” names " +
    "the parents of an organism. The plot “Selection” shows why the means of the genes change.",
  nothing_bred: "No generation has bred yet. The first one breeds when it ends and the next begins.",
  loading: "Loading …",

  // ---- choices ----
  generation: "Generation",
  generation_label: "Generation of the parents",
  follow: "the newest",
  follow_help: "Shows each new breeding when the steps of the last one are at their beginning or end.",
  bet: "bet first",
  bet_help: "Bet on the organisms that will be picked. The score compares the bets with random ones.",
  play_each: "play each",
  play_each_help: "Plays each breeding from the start when it appears; with bets, after the bets.",
  hold: "hold the world",
  hold_help:
    "While this panel is open, pauses the world after each generation, one tick into the next. Resuming runs one " +
    "more generation.",
  birth: "birth of the selected organism",
  tabs: {step: "Step", theory: "Theory", genes: "Why genes changed"},
  tabs_label: "What to show",

  // ---- steps ----
  play: "Play",
  stop: "Stop",
  play_help: "Plays or stops (Space).",
  to_begin: "To the beginning (Home)",
  previous_stage: "To the previous stage (Page Up)",
  back: "One step back (←)",
  forward: "One step forward (→)",
  next_stage: "To the next stage (Page Down)",
  to_end: "To the end (End)",
  speed_label: "Steps per second",
  speed: (steps_per_s: number): string => `${three_digits(steps_per_s)} steps/s`,
  speed_read: (steps_per_s: number): string => `${three_digits(steps_per_s)} steps per second`,
  position_label: "Step",
  position: (position: number, last: number): string => `step ${with_separators(position)} of ${with_separators(last)}`,
  stage_label: "Steps of the breeding. Left and right arrow: one step; Page Up, Page Down: stage; Space: play",
  play_picks: (picks: number, closes_bets: boolean): string =>
    `${closes_bets ? "Close the bets and play the" : "Play the"} ${counted(picks, "pick", "picks")}`,
  migrant: (organism: number, from: number, island: number): string =>
    `organism ${organism} is a copy of organism ${from} of island ${island}`,
  migrants: (shown: readonly string[], count: number): string =>
    `${counted(count, "organism", "organisms")} migrated to this island before the selection: ${shown.join("; ")}` +
    (count > shown.length ? `; and ${with_separators(count - shown.length)} more.` : "."),
  picks_legend: "picks in order; light: fittest, dark: lowest rank",

  // ---- bets ----
  bets_closed:
    "The bets are closed, because picks of this breeding have been shown. Choose another generation to bet again.",
  bets_question: (bets_max: number, offered: number, organisms: number): string =>
    `Which organisms will be picked most often? Choose up to ${bets_max}. ` +
    (offered < organisms ? `The ${offered} fittest organisms are offered, by rank.` :
                           "The fittest organism comes first."),
  bets_label: "Bets",
  bet_on: (organism: number, rank: number, fitness: number): string =>
    `organism ${organism}: rank ${rank + 1}, fitness ${fitness_text(fitness)}`,
  no_bets: "Your bets: none yet.",
  your_bets: (organisms: readonly number[]): string => `Your bets: ${organisms.join(", ")}.`,

  // ---- theory ----
  too_many: (rows_max: number): string =>
    `Theory needs all organisms; only the first ${with_separators(rows_max)} are requested.`,
  received: (received: number, all: number): string =>
    `${with_separators(received)} of ${with_separators(all)} organisms received …`,
  deviating: (count: number, ranks: number): string =>
    `${with_separators(count)} of ${with_separators(ranks)} ranks deviate by more than two standard errors`,
  after_picks: (made: number, all: number): string =>
    `After ${with_separators(made)} of ${counted(all, "pick", "picks")}. The deviations appear after the last pick.`,
  value: (value: number|null, unit: string): string =>
    value === null ? "–" : `${three_digits(Math.abs(value) < 1e-12 ? 0 : value)}${unit && " "}${unit}`,
  expected: (name: string, expected: string): string => `${name}: expected ${expected}`,
  expected_and_observed: (name: string, expected: string, observed: string): string =>
    `${name}: expected ${expected}, observed ${observed}`,
  standard_errors: (off: number): string => `${off_text(off)} standard errors`,
  source: (sentence: string, source: string): string => `${sentence} (${source})`,
  table: "All organisms as a table",
  gene_table: "Genes of the parents and of the descendant",
  table_columns: ["rank", "organism", "fitness", "expected", "picks", "off"],
  table_expected: (expected: number, error: number): string => `${three_digits(expected)} ± ${three_digits(error)}`,
  table_off: off_text,
  table_limited: (rows: number, all: number): string => `The ${rows} fittest of ${with_separators(all)} organisms.`,

  // ---- genes ----
  account_unknown: "The server does not know why the means of the genes changed.",
  account_later: (generation: number): string =>
    `The account appears when generation ${with_separators(generation)} has ended, if the server still keeps its ` +
    "statistics.",
  account: (generation: number): string =>
    `Why the mean of each gene changed from generation ${with_separators(generation)} to ` +
    `${with_separators(generation + 1)}, by Price's equation: the change is selection (which organisms had ` +
    "offspring) + transmission (crossover and mutation) + migration.",
  account_limited: (shown: number, all: number): string =>
    `The ${shown} of ${with_separators(all)} genes whose means changed most, in standard deviations.`,
  account_parts: {selection: "selection", transmission: "transmission", migration: "migration", change: "change"},

  // ---- drawings ----
  narrow_slots: (first: number, last: number): string => `organisms ${first} to ${last}: slots too narrow to draw`,
  slot_organism: (organism: number): string => `organism ${organism}`,
  slot_rank: (rank: number, of: number|null): string =>
    `rank ${with_separators(rank + 1)}${of === null ? "" : ` of ${with_separators(of)}`}`,
  slot_share: (share: number, wide: boolean): string => `${three_digits(100 * share)} %${wide ? " of the wheel" : ""}`,
  contestants: "Contestants in the order drawn",
  contestant_fitness: (fitness: number, won: boolean): string => fitness_text(fitness) + (won ? " won" : ""),
  unknown: "…",
  fitness: "Fitness",
  weight: "Weight",
  by_rank: (title: string, range: string): string => `${title} by rank: ${range}`,
  rank_range: (best: number, worst: number, count: number): string =>
    `${fitness_text(best)} (rank 1) to ${fitness_text(worst)} (rank ${with_separators(count)})`,
  ranks: (first: number, last: number): string => `ranks ${first + 1} to ${last + 1}`,
  picks_in_order: (pick: number, count: number): string => `Picks in order: ${pick + 1} of ${count}`,
  one_pick: (pick: number): string => `pick ${pick + 1}`,
  copies_label: "Picks by rank, observed and expected; the table below has the numbers",
  copies_title: "Picks by rank; line: expected ± standard error",
  deviation_title: "Deviation in standard errors",
  plus_two: "+2",
  minus_two: "−2",
  one_rank: (rank: number, organism: number, fitness: number): string =>
    `rank ${rank + 1}: organism ${organism}, fitness ${fitness_text(fitness)}`,
  copies: (copies: number, expected: number, error: number, deviation: number|null): string =>
    `; picks ${with_separators(copies)}, expected ${three_digits(expected)} ± ${three_digits(error)}` +
    (deviation === null ? "" : `; ${with_sign(deviation)} standard errors`),
  rank_label: (rank: number): string => `rank ${with_separators(rank + 1)}`,
  next_generation: "The next generation",
  descendant_of: (organism: number, count: number): string => `Organism ${organism} of ${count} in the next generation`,
  elite: "elite",
  survivors: "survivors",
  children: "children",
  first_parent: "gene of the first parent",
  second_parent: "of the second parent",
  blended: "blended",
  cut: "cut",
  mutated: "mutated or clamped",
  contradiction: "The genes of this organism are unknown: its lists contradict each other.",
  unnamed_gene: (gene: number): string => `gene ${gene + 1}`,
  itself: "itself",
  parent: "parent",
  gene_received: (gene: string, received: boolean): string =>
    `${gene}: the child ${received ? "received" : "did not receive"} this gene`,
  crossed: "crossed",
  from_both: (gene: string): string => `${gene}: a mean of both parents`,
  from_first: (gene: string): string => `${gene}: from the first parent`,
  from_second: (gene: string): string => `${gene}: from the second parent`,
  order: "order",
  moved_from: (gene: string): string => `from ${gene}`,
  mutations: "mutations",
  mutation: (delta: string, how: string): string => `${delta} by ${how}`,
  changed_to: (value: string): string => `→ ${value}`,
  organism_row: (organism: number): string => `organism ${organism}`,
  other_genes: "Other genes",
  other_genes_help: "Point at a cell to read its gene; with the keyboard: arrow keys.",
};
