// The tab "Theory" of the glass box: what the law of the selection method predicts, next to what was observed.
import {selection_law_text} from "../breeding/caption";
import type {Comparison} from "../breeding/comparison";
import {copies_so_far, type Progress} from "../breeding/progress";
import {type BreedingRecord, rows_kept_max} from "../breeding/record";
import {deviation_of, type Prediction, predictions, selection_of} from "../breeding/theory";
import {glass_box_texts} from "../texts/glass_box";
import {fitness_text, with_separators} from "../texts/numbers";
import {h} from "../widgets/dom";
import {hint} from "../widgets/form";
import {draw_copies} from "./glass_box_drawings";

const table_rows_max = 200;

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
                     cell(fitness_text(comparison.fitness[rank]!)),
                     cell(glass_box_texts.table_expected(comparison.expected[rank]!, comparison.standard_error[rank]!)),
                     cell(with_separators(copies[rank]!)),
                     cell(complete ? glass_box_texts.table_off(comparison.deviations[rank]!) : "")));
  const heads = glass_box_texts.table_columns.map((name) => h("th", {scope: "col", class: "number"}, name));
  return h(
    "details", {}, h("summary", {}, glass_box_texts.table),
    h("div", {class: "glass-table"},
      h("table", {class: "table", "aria-label": glass_box_texts.table}, h("thead", {}, h("tr", {}, ...heads)),
        h("tbody", {}, ...rows))),
    comparison.organisms.length > table_rows_max &&
      hint(glass_box_texts.table_limited(table_rows_max, comparison.organisms.length)));
}
