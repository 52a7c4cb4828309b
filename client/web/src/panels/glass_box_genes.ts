// The tab "Why genes changed" of the glass box: the account of each gene by Price's equation.
import {accounts_of, type GeneChangeOfMean, most_changed, reason_text} from "../breeding/account";
import type {BreedingKey} from "../breeding/record";
import type {GenerationStatistics} from "../core/protocol";
import {account_texts} from "../texts/breeding_theory";
import {glass_box_texts} from "../texts/glass_box";
import {h, svg} from "../widgets/dom";
import {hint} from "../widgets/form";
import {svg_line, svg_rect} from "../widgets/svg";

const genes_shown_max = 12;
const parts = ["selection", "transmission", "migration", "change"] as const;

/** Statistics of the generation that this breeding made; null until that generation has ended.
 *
 *  history  ordered by generation */
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
    "section", {class: "organism-part account"}, h("p", {}, account_texts.change(account)), hint(reason_text(account)),
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
