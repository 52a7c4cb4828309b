// Account: why the mean of each gene changed from the parents' generation to the next one, by Price's equation:
// selection + transmission + migration = change. No DOM.
import {gene_label} from "../organism/texts";
import type {Message} from "../core/messages";
import {with_sign} from "../texts/numbers";

export interface GeneChangeOfMean {
  gene: number;
  name: string;
  mean: number; // in the next generation
  selection: number;
  transmission: number;
  migration: number;
  change: number;
  relative: number; // change / standard deviation in the next generation; 0 if all values are equal
}

/** Returns the account of every gene; empty if the server does not know it.
 *
 *  next  GenerationStatistics of the generation after the parents' one, on the same island */
export function accounts_of(next: Message|null, gene_names: readonly string[]): GeneChangeOfMean[] {
  const genes: Message[] = next?.genes ?? [];
  return genes.flatMap((statistics, gene) => {
    const account = statistics.account;
    if (!account) {
      return [];
    }
    const change: number = account.change ?? 0, deviation: number = statistics.deviation ?? 0;
    return [{
      gene,
      name: gene_label(gene_names[gene] ?? `gene ${gene}`),
      mean: statistics.mean ?? 0,
      selection: account.selection ?? 0,
      transmission: account.transmission ?? 0,
      migration: account.migration ?? 0,
      change,
      relative: deviation > 0 ? change / deviation : 0,
    }];
  });
}

/** The genes whose means changed most, in standard deviations of the gene, the largest change first. */
export function most_changed(accounts: readonly GeneChangeOfMean[], count: number): GeneChangeOfMean[] {
  return [...accounts].sort((a, b) => Math.abs(b.relative) - Math.abs(a.relative) || a.gene - b.gene).slice(0, count);
}

/** "The mean of normal speed rose by 0.3: selection +0.4, transmission −0.1, migration 0." */
export function account_text(account: GeneChangeOfMean): string {
  const verb = account.change > 0 ? "rose by " : account.change < 0 ? "fell by " : "did not change";
  const size = account.change === 0 ? "" : with_sign(Math.abs(account.change)).slice(1);
  return `The mean of ${account.name} ${verb}${size}: selection ${part(account.selection)}, transmission ` +
    `${part(account.transmission)}, ` +
    `migration ${part(account.migration)}.`;
}

function part(number: number): string {
  return number === 0 ? "0" : with_sign(number);
}

/** The largest part as a sentence for pupils. */
export function reason_text(account: GeneChangeOfMean): string {
  const {selection, transmission, migration, change} = account;
  const largest = Math.max(Math.abs(selection), Math.abs(transmission), Math.abs(migration));
  if (change === 0 || largest === 0) {
    return "";
  }
  return largest === Math.abs(selection) ?
    (selection > 0 ? "Organisms with more of it had more descendants." :
                     "Organisms with less of it had more descendants.") :
    largest === Math.abs(transmission) ?
    `Crossover and mutation gave the descendants ${transmission > 0 ? "more" : "less"} of it than their parents ` +
      "had." :
    `The migrants had ${migration > 0 ? "more" : "less"} of it.`;
}
