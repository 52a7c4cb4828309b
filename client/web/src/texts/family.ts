// Texts of the panel "Family tree".
import {choice_text, counted} from "./breeding";
import {fitness_text, three_digits, with_separators} from "./numbers";

interface Named {
  generation: number;
  island: number;
  organism: number;
}

interface Described extends Named {
  parents: readonly Named[];
  origin: string;
  fitness: number|null;
  child_count: number;
  kept_count: number;
}

function of_island(island: number): string {
  return island > 0 ? ` of island ${island}` : "";
}

/** "organism 17 of generation 40" */
function name(organism: Named): string {
  return `organism ${organism.organism}${of_island(organism.island)} of generation ` +
    with_separators(organism.generation);
}

/** "organisms 3, 17 and 4 more" */
function names(organisms: readonly Named[]): string {
  const shown = organisms.slice(0, 5).map(({organism, island}) => `${organism}${of_island(island)}`);
  const rest = organisms.length - shown.length;
  const last = rest > 0 ? `${with_separators(rest)} more` : shown.pop()!;
  return `${organisms.length === 1 ? "organism" : "organisms"} ` +
    (shown.length === 0 ? last : `${shown.join(", ")} and ${last}`);
}

function earlier(generations: number): string {
  return `${counted(generations, "generation", "generations")} earlier`;
}

export const family_texts = {
  title: "Family tree",
  subject: "What to show",
  ancestors: "ancestors of one organism",
  whole: "whole generation",
  generations: "Generations",
  generation_count: (count: number): string => `${count} generations`,
  both_parents: "both parents",
  order: "Order",
  order_lines: "order: few crossings",
  order_fitness: "order: fittest first",
  colours: "Colours",
  colour_nothing: "colours: none",
  colour_lineage: "colours: lineage",
  colour_fitness: "colours: fitness",
  colour_gene: (gene: string): string => `colours: ${gene}`,
  retry: "Retry",
  loading: "Loading …",
  zoom_in: "Zoom in (+)",
  zoom_out: "Zoom out (−)",
  fit: "Fit",
  fit_title: "Show the whole width (0)",
  mark: "Mark for comparison (M)",
  unmark: "Remove the mark (M)",
  no_marks: "Remove both marks",

  heading_ancestors: (organism: number, generation: number): string =>
    `Ancestors of organism ${organism} of generation ${with_separators(generation)}`,
  heading_whole: (generation: number, island: number): string =>
    `Generation ${with_separators(generation)}${of_island(island)} and its ancestors`,
  tree_of_organism: (organism: number): string => `Tree of organism ${organism}`,
  tree_of_generation: (generation: number): string => `Tree of generation ${with_separators(generation)}`,
  select_first: "Select an organism to see its ancestors.",
  no_world: "Waiting for the first snapshot …",
  unknown: (problem: string): string => `The ancestors are unknown: ${problem}.`,
  not_stored: "No organism of this generation is stored.",

  drawing: (generations: number, organisms: number): string =>
    `Family tree of ${counted(generations, "generation", "generations")} with ` +
    `${counted(organisms, "organism", "organisms")}. Arrow keys move between relatives, Enter shows the moment, ` +
    "M marks an organism for comparison. The same organisms are in the table below.",
  loaded: (organisms: number, bytes: number): string =>
    `Loaded: ${counted(organisms, "organism", "organisms")}, ${three_digits(bytes / 1e6)} MB.`,
  limited: (shown: number, wanted: number, organisms_max: number): string =>
    `Only the last ${shown} of ${wanted} generations are shown: a tree may have about ` +
    `${with_separators(organisms_max)} organisms.`,
  left_out: (generations: number): string =>
    `${counted(generations, "generation is", "generations are")} missing, because the run file does not contain ` +
    "the organisms.",
  loading_genes: (loaded: number, all: number): string => `Genes: ${loaded} of ${all} generations loaded …`,
  genes_limited: (generations: number, values_max: number): string =>
    `The genes of the last ${counted(generations, "generation", "generations")} are loaded: at most ` +
    `${with_separators(values_max)} numbers.`,
  genes_unknown: (problem: string): string => `The genes are unknown: ${problem}.`,

  /** "Organism 45 of generation 4: a child of 3 and 7, fitness 123; 2 children and 1 copy in the next generation." */
  organism: ({generation, island, organism, parents, origin, fitness, child_count, kept_count}: Described): string => {
    const named =
      parents.map((parent) => `${parent.organism}${parent.island === island ? "" : ` of island ${parent.island}`}`)
        .join(" and ");
    const kind = parents.length === 0 ? (origin === "placed" ? "placed by a user" : "without known parents") :
      origin === "elite"              ? `of the elite, a copy of ${named}` :
                   origin === "survivor" ? `a survivor, a copy of ${named}` :
                                           `a child of ${named}`;
    const next = [
      ...(child_count > 0 ? [counted(child_count, "child", "children")] : []),
      ...(kept_count > 0 ? [counted(kept_count, "copy", "copies")] : []),
    ].join(" and ");
    return `Organism ${organism} of generation ${with_separators(generation)}` +
      `${island > 0 ? `, island ${island}` : ""}: ${kind}` +
      (fitness === null ? "" : `, fitness ${fitness_text(fitness)}`) +
      (next ? `; ${next} in the next generation` : "") + ".";
  },
  of_lineage: (founder: Named): string => ` Lineage of ${name(founder)}.`,
  gene_value: (gene: string, value: string): string => ` ${gene}: ${value}.`,
  is_ancestor_of_all: " A common ancestor of all.",
  is_ancestor_of_both: " A common ancestor of the two marked organisms.",
  is_marked: (letter: string): string => ` Marked as ${letter}.`,

  changed_genes:
    (changes:
       readonly {
         gene: string;
         before: string;
         after: string;
         how: string
       }[],
     more: number): string => changes.length === 0 ?
    "No gene mutated." :
    `Mutated genes: ${
      changes.map(({gene, before, after, how}) => `${gene} ${before} → ${after} (${how})`).join("; ")}` +
      (more > 0 ? `; and ${with_separators(more)} more.` : "."),
  order_mutated: (method: string): string => ` The order of the genes mutated (${choice_text(method)}).`,
  loading_changes: "Loading the changed genes …",
  changes_unknown: (problem: string): string => `The changed genes are unknown: ${problem}.`,

  all_descend_from: (count: number, generation: number, ancestors: readonly Named[], first_parents: boolean): string =>
    `${first_parents ? "Along first parents, all" : "All"} ${with_separators(count)} organisms of generation ` +
    `${with_separators(generation)} descend from ${names(ancestors)} of generation ` +
    `${with_separators(ancestors[0]!.generation)}, ${earlier(generation - ancestors[0]!.generation)}: ` +
    (ancestors.length === 1 ? "their most recent common ancestor." : "their most recent common ancestors."),
  all_are_ancestors: (generation: number): string =>
    ` Up to generation ${with_separators(generation)}, every organism of the tree is an ancestor of all.`,
  no_ancestor_of_all: (count: number, generation: number, since: number, first_parents: boolean): string =>
    `The ${with_separators(count)} organisms of generation ${with_separators(generation)} have no common ancestor` +
    `${first_parents ? " along first parents" : ""} since generation ${with_separators(since)}.`,
  mark_two: "Mark two organisms (M, or Shift and click) to find their common ancestors.",
  mark_another: (one: Named): string => `A: ${name(one)}. Mark another organism to find their common ancestors.`,
  marked: (one: Named, other: Named): string => `A: ${name(one)}. B: ${name(other)}. `,
  two_descend_from: (ancestors: readonly Named[]): string =>
    `Most recent common ${ancestors.length === 1 ? "ancestor" : "ancestors"} of both: ${
      names(ancestors)} of generation ` +
    `${with_separators(ancestors[0]!.generation)}.`,
  one_descends_from_other: (ancestor: string, descendant: string): string =>
    `${ancestor} is an ancestor of ${descendant}.`,
  two_have_none: (since: number): string => `They have no common ancestor since generation ${with_separators(since)}.`,

  legend: "Colours of the organisms",
  legend_lineages: (generation: number): string => `Lineages since generation ${with_separators(generation)}:`,
  legend_lineage: (founder: Named, count: number): string =>
    `${founder.organism}${of_island(founder.island)} (${with_separators(count)})`,
  legend_others: (lineages: number, count: number): string =>
    `${counted(lineages, "smaller lineage", "smaller lineages")} (${with_separators(count)})`,
  legend_grey: "grey: other lineages",
  legend_unknown: (count: number): string => `unknown: ${counted(count, "organism", "organisms")}`,

  help_lines:
    "Thick lines lead to first parents, which gave at least half of the genes; thin lines lead to second parents. " +
    "Filled: children; hollow: copies (survivors, elite); diamond: the first parent lived on another island; " +
    "double ring: a common ancestor.",
  help_keys:
    "Click an organism to see the beginning of its generation. Ctrl and the mouse wheel zoom; dragging moves the " +
    "tree. " +
    "With the keyboard: arrow keys (Shift and ↑: second parent), Home, End, Enter, M, +, −, 0.",

  table: "The organisms as a table",
  table_of: "Generation of the table",
  table_rows: (first: number, last: number, all: number): string =>
    `Rows ${with_separators(first)} to ${with_separators(last)} of ${with_separators(all)}`,
  table_columns: ["organism", "kind", "parents", "fitness", "children", "copies", "common ancestor"],
  on_island: (organism: number, island: number): string => `${organism} of island ${island}`,
  table_ancestor_of_all: "of all",
  table_ancestor_of_both: "of A and B",
  previous_rows: "Previous rows",
  next_rows: "Next rows",
  kinds: {initial: "first generation", elite: "elite", survivor: "survivor", child: "child", placed: "placed"} as
    {[origin: string]: string | undefined},

  no_column: (column: string): string => `the lineage table has no column ${column}`,
  wrong_row: (line: string): string => `the lineage table has a row without an organism: ${line}`,
};
