// Account: why the mean of each gene changed from the parents' generation to the next one, by Price's equation:
// selection + transmission + migration = change. No DOM.
import {gene_label} from "../organism/texts";
import type {GenerationStatistics} from "../core/protocol";
import {account_texts} from "../texts/breeding_theory";

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
export function accounts_of(next: GenerationStatistics|null, gene_names: readonly string[]): GeneChangeOfMean[] {
  return (next?.genes ?? []).flatMap((statistics, gene) => {
    const account = statistics.account;
    if (!account) {
      return [];
    }
    const change = account.change ?? 0, deviation = statistics.deviation ?? 0;
    return [{
      gene,
      name: gene_label(gene_names[gene] ?? account_texts.unnamed_gene(gene)),
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

/** The largest part as a sentence; empty if nothing changed. */
export function reason_text({selection, transmission, migration, change}: GeneChangeOfMean): string {
  const largest = Math.max(Math.abs(selection), Math.abs(transmission), Math.abs(migration));
  return change === 0 || largest === 0 ? "" :
    largest === Math.abs(selection)    ? account_texts.by_selection(selection > 0) :
    largest === Math.abs(transmission) ? account_texts.by_transmission(transmission > 0) :
                                         account_texts.by_migration(migration > 0);
}
