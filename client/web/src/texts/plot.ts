// plot: what a plot says itself, whatever it shows, and the fitness curve of the column.
import {shown_number, with_separators} from "./numbers";

export const plot_texts = {
  role: "plot",
  no_numbers: "no numbers",
  /** The name of a plot for screen readers. */
  described: (title: string, hint: string) => `${title}: ${hint}`,
  keys: (chooses: boolean) => `left and right arrow keys read the numbers; ${
    chooses ? "Enter chooses a generation; " : ""}plus and minus zoom; 0 shows everything`,
  shows_or_hides: (series: string) => `Shows or hides ${series}`,

  value: (series: string, value: string) => `${series}: ${value}`,
  band: (low: string, high: string) => `${low} to ${high}`,
  smoothed: (raw: string, mean_name: string, mean: string) => `${raw} (${mean_name}: ${mean})`,
  mean: "mean",
  mean_of: (window: number) => `mean of the last ${window} generations`,
  mark_of: (mark: string, history: string) => `${mark} (${history})`,
  more: (count: number) => `and ${with_separators(count)} more`,

  generation: "generation",
  fitness: "fitness",
  best: "best",
  curve_title: (generation: number, births: boolean) =>
    `${births ? "Children, interval" : "Fitness, generation"} ${shown_number(generation)}`,
  no_curve: "Fitness: the curve begins when the first generation ends",
  changed: (generation: number, values: string, actor: string) => `generation ${generation}: ${values} by ${actor}`,
  click_shows: (first: number) =>
    `A click shows this generation in a replay${first > 1 ? `, from generation ${with_separators(first)} on` : ""}.`,
  begins: (generation: number) =>
    `The run of this world can be shown from generation ${with_separators(generation)} on.`,
};
