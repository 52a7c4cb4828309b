// GlassBoxTabs: the tabs of the glass box, "Step", "Theory" and "Why genes changed". A tab is drawn only when what it
// shows has changed.
import {account_text, accounts_of, type GeneChangeOfMean, most_changed, reason_text} from "../breeding/account";
import {caption, selection_law_text} from "../breeding/caption";
import {type Comparison, copies_so_far, type Progress, progress_of} from "../breeding/comparison";
import type {BreedingFeed} from "../breeding/feed";
import {type BreedingKey, type BreedingRecord, rows_kept_max} from "../breeding/record";
import {deviation_of, type Prediction, predictions, selection_of} from "../breeding/theory";
import type {GenerationStatistics} from "../core/protocol";
import {glass_box_texts} from "../texts/glass_box";
import {three_digits, with_separators} from "../texts/numbers";
import {h, set_text, svg} from "../widgets/dom";
import {svg_line, svg_rect} from "../widgets/svg";
import {hint} from "../widgets/form";
import type {ViewedWorld} from "../world/world";
import type {BetControls} from "./glass_box_bets";
import {draw_copies} from "./glass_box_drawings";
import {Stage} from "./glass_box_stage";
import type {StepControls} from "./glass_box_steps";

const genes_shown_max = 12;
const parts = ["selection", "transmission", "migration", "change"] as const;

/** Statistics of the generation that this breeding made; null until that generation has ended.
 *
 *  history  ordered by generation */
/** The tab "Why genes changed" of the glass box: the account of each gene by Price's equation. */
export function next_statistics(history: readonly GenerationStatistics[], key: BreedingKey): GenerationStatistics|null {
  for (let i = history.length - 1; i >= 0 && (history[i]!.generation ?? 0) > key.generation; --i) {
    if (history[i]!.generation === key.generation + 1 && (history[i]!.island ?? 0) === key.island) {
      return history[i]!;
    }
  }
  return null;
}

export function gene_parts(generation: number, gene_names: readonly string[], next: GenerationStatistics|null): Node[] {
  const accounts = accounts_of(next, gene_names);
  if (accounts.length === 0) {
    return [h("p", {}, next ? glass_box_texts.account_unknown : glass_box_texts.account_later(generation + 1))];
  }
  const is_limited = accounts.length > genes_shown_max;
  const shown = is_limited ? most_changed(accounts, genes_shown_max) : accounts;
  const most = Math.max(1e-12, ...shown.flatMap((account) => parts.map((part) => Math.abs(account[part]))));
  return [
    h("p", {}, glass_box_texts.account(generation)),
    ...(is_limited ? [hint(glass_box_texts.account_limited(shown.length, accounts.length))] : []),
    ...shown.map((account) => draw_account(account, is_limited ? null : most)),
  ];
}

/** One gene: its sentence, and a bar for each part of the change. most: the end of the axis; null: that of this gene
 *  alone. */
function draw_account(account: GeneChangeOfMean, most: number|null): HTMLElement {
  const end = most ?? Math.max(1e-12, ...parts.map((part) => Math.abs(account[part])));
  return h(
    "section", {class: "organism-part account"}, h("p", {}, account_text(account)), hint(reason_text(account)),
    h("div", {class: "account-bars", "aria-hidden": "true"}, ...parts.flatMap((part) => {
      const value = account[part], width = Math.abs(value) / end * 50;
      return [
        h("span", {class: "hint"}, glass_box_texts.account_parts[part]),
        svg(
          "svg", {class: "account-bar", viewBox: "0 0 100 10", preserveAspectRatio: "none"},
          svg_rect(part, [value < 0 ? 50 - width : 50, 1, width, 8]), svg_line("axis", [50, 0, 50, 10]))
      ];
    })));
}

const table_rows_max = 200;

/** The tab "Theory" of the glass box: what the law of the selection method predicts, next to what was observed. */
export function theory_parts(
  record: BreedingRecord, comparison: Comparison|null, progress: Progress, width: number): Node[] {
  const law = h("p", {}, selection_law_text(record));
  if (!comparison) {
    return [
      law,
      hint(
        record.contender_count > rows_kept_max ?
          glass_box_texts.too_many(rows_kept_max) :
          glass_box_texts.received(record.contenders.length, record.contender_count))
    ];
  }
  const picks = record.head?.pick_count ?? 0, {made, complete} = progress;
  const copies = copies_so_far(record, comparison, progress);
  return [
    law,
    draw_copies(record, comparison, copies, picks > 0 ? made / picks : 1, complete, width),
    h("p", {},
      complete ? glass_box_texts.deviating(comparison.beyond_two, comparison.organisms.length) :
                 glass_box_texts.after_picks(made, picks)),
    ...predictions(selection_of(record), comparison).map((prediction) => prediction_part(prediction, complete)),
    organism_table(comparison, copies, complete),
  ];
}

function prediction_part(prediction: Prediction, complete: boolean): HTMLElement {
  const {name, unit, sentence, source} = prediction;
  const off = deviation_of(prediction), observed = complete ? prediction.observed : null;
  const expected = glass_box_texts.value(prediction.expected, unit);
  return h(
    "section", {class: "organism-part"},
    h("p", {},
      observed === null ? glass_box_texts.expected(name, expected) :
                          glass_box_texts.expected_and_observed(name, expected, glass_box_texts.value(observed, unit))),
    complete && off !== null && h("p", {}, glass_box_texts.standard_errors(off)),
    hint(glass_box_texts.source(sentence, source)));
}

function organism_table(comparison: Comparison, copies: readonly number[], complete: boolean): HTMLElement {
  const cell = (text: string): HTMLElement => h("td", {class: "number"}, text);
  const rows = comparison.organisms.slice(0, table_rows_max)
                 .map(
                   (organism, rank) => h(
                     "tr", {}, cell(with_separators(rank + 1)), cell(String(organism)),
                     cell(three_digits(comparison.fitness[rank]!)),
                     cell(glass_box_texts.table_expected(comparison.expected[rank]!, comparison.standard_error[rank]!)),
                     cell(with_separators(copies[rank]!)),
                     cell(complete ? glass_box_texts.table_off(comparison.deviations[rank]!) : "")));
  const heads = glass_box_texts.table_columns.map((name) => h("th", {scope: "col", class: "number"}, name));
  return h(
    "details", {}, h("summary", {}, glass_box_texts.table),
    h("div", {class: "glass-table"},
      h("table", {class: "table"}, h("thead", {}, h("tr", {}, ...heads)), h("tbody", {}, ...rows))),
    comparison.organisms.length > table_rows_max &&
      hint(glass_box_texts.table_limited(table_rows_max, comparison.organisms.length)));
}

const tabs = ["step", "theory", "genes"] as const;
type Tab = typeof tabs[number];

export class GlassBoxTabs {
  readonly element: HTMLElement;
  #tab: Tab = "step";
  #drawn = ""; // what the open tab shows
  readonly #steps: StepControls;
  readonly #bets: BetControls;
  readonly #changed: () => void;

  readonly #buttons =
    tabs.map((tab) => h("button", {class: "button", onclick: () => this.open(tab)}, glass_box_texts.tabs[tab]));
  readonly #caption = h("p", {class: "glass-caption", "aria-live": "polite"});
  readonly #score = h("p", {class: "glass-score", role: "status"});
  readonly #stage = new Stage(
    (stage, index) => this.#steps.move(() => this.#steps.stepper.go_to(this.#steps.stepper.begin_of(stage) + index)));
  readonly #play_all = h("button", {class: "button button-primary", onclick: () => this.#play_picks()});
  readonly #theory = h("div", {class: "panel"});
  readonly #genes = h("div", {class: "panel"});

  constructor(steps: StepControls, bets: BetControls, changed: () => void) {
    this.#steps = steps;
    this.#bets = bets;
    this.#changed = changed;
    this.element =
      h("div", {class: "panel"},
        h("div", {class: "row glass-tabs", role: "group", "aria-label": glass_box_texts.tabs_label}, ...this.#buttons),
        this.#caption, this.#score, this.#stage.element, this.#theory, this.#genes);
  }

  open(tab: Tab): void {
    this.#tab = tab;
    this.#changed();
  }

  /** Draws the open tab at the next update, even if nothing has changed. */
  forget(): void {
    this.#drawn = "";
  }

  update(world: ViewedWorld, {comparison}: BreedingFeed, record: BreedingRecord, width: number): void {
    const progress = progress_of(record, this.#steps.stepper.moment);
    this.#buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(tabs[i] === this.#tab)));
    this.#caption.hidden = this.#stage.element.hidden = this.#tab !== "step";
    this.#theory.hidden = this.#tab !== "theory";
    this.#genes.hidden = this.#tab !== "genes";
    set_text(
      this.#play_all, glass_box_texts.play_picks(record.pick_count, this.#bets.chosen.checked && this.#bets.any));
    set_text(this.#score, this.#bets.score_line(record, comparison, progress));
    this.#score.hidden = this.#tab === "genes" || this.#score.textContent === "";
    const next = next_statistics(world.history.generations, record.key);
    const drawn = [
      this.#tab, record.key.run_id, record.key.island, record.key.generation, this.#steps.stepper.position,
      record.contenders.length, record.picks.length, record.descendants.length, width, world.gene_names.length,
      this.#tab === "genes" && next !== null, this.#bets.closed
    ].join("/");
    if (drawn === this.#drawn) {
      return;
    }
    this.#drawn = drawn;
    switch (this.#tab) {
      case "step": {
        const {moment, playing} = this.#steps.stepper;
        const bets = this.#bets.chosen.checked && comparison ? this.#bets.parts(record, comparison) : [];
        set_text(this.#caption, caption(record, moment));
        this.#caption.setAttribute("aria-live", playing ? "off" : "polite");
        this.#stage.draw({record, comparison, moment, progress, width}, world, [...bets, this.#play_all]);
        break;
      }
      case "theory":
        this.#theory.replaceChildren(...theory_parts(record, comparison, progress, width));
        break;
      case "genes":
        this.#genes.replaceChildren(...gene_parts(record.key.generation, world.gene_names, next));
        break;
    }
  }

  #play_picks(): void {
    this.#steps.move(() => {
      this.#steps.stepper.step();
      this.#steps.stepper.play();
    });
    this.#stage.element.focus();
  }
}
