// FitnessCurve: the curves of the best and the mean fitness in the column. A click shows a generation in a replay.
import {Plot} from "./plot";
import type {Series, SeriesColour} from "./plot_content";
import {running_mean} from "./plot_layout";
import {marks_of} from "./change_marks";
import {HistoryTable} from "./history_table";
import type {Column} from "./history_table";
import {fitness_text} from "../texts/numbers";
import {plot_texts} from "../texts/plot";
import type {PanelContext} from "../world/panel_context";
import type {ViewedWorld} from "../world/world";

const generations_in_mean = 10;

/** Shows a generation that the user has chosen in a plot, or the first one of the run: a fork shows the statistics of
 *  earlier ones, too. */
export async function show_generation(context: PanelContext, generation: number): Promise<void> {
  const {past} = context.world();
  if (await context.attempt(() => past.show_nearest({generation}))) {
    const first = past.range?.first_generation ?? 1;
    if (generation < first) {
      context.notify(plot_texts.begins(first));
    }
  }
}

export class FitnessCurve {
  readonly element: HTMLElement;
  readonly #plot: Plot;
  readonly #table = new HistoryTable();
  #revision = -1;
  #changes: unknown = null;
  #change_count = 0;
  #first = 1; // generation of the run; a fork shows the fitness of earlier ones, too

  /** on_click: the user chose this generation. */
  constructor(on_click: (generation: number) => void) {
    this.#plot = new Plot({height: 64, axes: false, on_click});
    this.element = this.#plot.element;
  }

  /** Draws the history of the world if it has changed. */
  update(world: ViewedWorld): void {
    this.#table.set_history(world.history.generations);
    const first = world.past.range?.first_generation ?? 1;
    if (
      this.#table.revision === this.#revision && first === this.#first && world.history.changes === this.#changes &&
      world.history.changes.length === this.#change_count) {
      return;
    }
    this.#revision = this.#table.revision;
    this.#first = first;
    this.#changes = world.history.changes;
    this.#change_count = world.history.changes.length;
    const x = this.#table.column(null, "generation");
    const line = (name: string, column: Column, colour: SeriesColour): Series => {
      const raw = this.#table.column(null, column);
      return {
        kind: "line",
        name,
        colour,
        x,
        y: running_mean(raw, generations_in_mean),
        raw,
        newest: fitness_text(raw[raw.length - 1]!)
      };
    };
    const known = x.length > 0;
    this.#plot.set_content({
      title: known ? plot_texts.curve_title(x[x.length - 1]!, world.has_births) : plot_texts.no_curve,
      series: known ?
        [line(plot_texts.best, "fitness_best", "vermilion"), line(plot_texts.mean, "fitness_mean", "blue")] :
        [],
      x_label: plot_texts.generation,
      y_label: plot_texts.fitness,
      counted_x: true,
      from_zero: world.has_bodies,
      smoothed: plot_texts.mean_of(generations_in_mean),
      marks: known ? [{marks: marks_of(world.history.changes), name: ""}] : [],
      note_end: plot_texts.click_shows(first),
    });
  }

  close(): void {
    this.#plot.close();
  }
}
