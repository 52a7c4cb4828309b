// Texts of the panel "Freezer" and of files with chromosomes.
import {with_separators} from "./numbers";

const counted = (count: number, one: string, many: string): string =>
  `${with_separators(count)} ${count === 1 ? one : many}`;
const mebibytes = (bytes: number): string =>
  bytes > 0 && bytes < 52_429 ? "less than 0.1" : (bytes / (1 << 20)).toFixed(1).replace(/\.0$/, "");
const organisms = (count: number): string => counted(count, "organism", "organisms");

export const freezer_texts = {
  title: "Freezer",
  about: "Keeps organisms and whole populations in this browser, to compare them with others and to place copies of " +
    "them in any world later.",

  // ---- keeping ----
  name: "Name",
  as: "as",
  name_hint: "empty: world and generation",
  keep: "Keep",
  keep_selected: "Selected",
  keep_selected_help: "Keeps the genes of the selected organism.",
  keep_healthiest: "Healthiest",
  keep_healthiest_help: "Keeps the genes of the organism that has the most health now.",
  keep_population: "Population",
  keep_population_help: "Keeps the genes of all organisms of the shown generation, of all islands, alive and dead. " +
    "The time line shows earlier generations.",
  open_files: "Open files …",
  open_files_help: "Opens CSV files of chromosomes. You can also drop them on this panel.",
  no_selection: "No organism is selected: click one in the island.",
  none_alive: "No organism is alive.",
  kept: (name: string, count: number) => `Kept ${organisms(count)} as ${name}.`,
  busy: "Reading …",

  // ---- the list ----
  list: "Kept organisms and populations",
  list_headings: ["Name", "Content", "From"],
  nothing: "Nothing is kept yet.",
  content: (count: number, islands: number, genes: number) =>
    `${organisms(count)}${islands > 1 ? ` on ${with_separators(islands)} islands` : ""}, ${
      counted(genes, "gene", "genes")}${count === 1 ? "" : " each"}`,
  from_organism: (world: string, generation: number, island: number, organism: number) =>
    `${world}, generation ${with_separators(generation)}, island ${island}, organism ${organism}`,
  from_population: (world: string, generation: number) => `${world}, generation ${with_separators(generation)}`,
  from_file: (file: string) => `file ${file}`,
  usage: (count: number, bytes: number, bytes_max: number) =>
    `${with_separators(count)} kept, ${mebibytes(bytes)} of ${mebibytes(bytes_max)} MiB.`,
  where: (address: string) => `Only this browser has them, and only for ${address}. Download them as files to ` +
    "use them elsewhere, or before you clear the data of the browser.",

  // ---- the chosen entry ----
  cannot_place: "This server cannot place anything; a newer version of evod can.",
  replay: "A replay cannot be changed; fork it, and change the fork.",
  place: "Place by clicks",
  place_help: "Then each click in the island places a copy. Esc ends this.",
  placing: (name: string) => `Click in the island to place ${name}. Esc ends this.`,
  copies: "copies",
  scatter: "Place at random places",
  scatter_help: "Places as many copies on the shown island, where nothing is in their way.",
  scattered: (name: string, count: number, world: string, island: number) =>
    `Placed ${counted(count, "copy", "copies")} of ${name} in ${world}, island ${island}.`,
  no_room: (placed: number, wanted: number) =>
    `Placed ${with_separators(placed)} of ${counted(wanted, "copy", "copies")}: ` +
    "no free place was found for the next one.",
  create: "New world …",
  create_help: "Creates a world whose first generation is this population.",
  create_copies_help: "Creates a world whose first organisms are copies of this one.",
  download: "Download",
  download_help: (file: string) => `Saves ${file}, which evod and evoctl can open.`,
  rename: "Rename …",
  new_name: "New name",
  do_rename: "Rename",
  remove: "Delete …",
  ask_remove: (name: string) => `Delete ${name}? You cannot undo this.`,
  do_remove: "Delete it",
  island: "island",
  organism: "organism",
  organism_name: (entry: string, island: number, organism: number, islands: number) =>
    `organism ${organism} of ${entry}${islands > 1 ? `, island ${island}` : ""}`,
  a_copy_of: (name: string) => `a copy of ${name}`,

  // ---- the comparison ----
  gene_table: "Genes of the kept organism",
  gene_headings: ["Gene", "Kept"],
  difference: "Difference",
  range_heading: "Lowest…highest",
  nothing_to_compare: "Select an organism in the island to compare its genes.",
  other: (organism: number) => `Organism ${organism}`,
  equal: (organism: number, common: number) => `Organism ${organism} has the same ${counted(common, "gene", "genes")}.`,
  different: (organism: number, different: number, common: number) =>
    `Organism ${organism} differs in ${with_separators(different)} of ${counted(common, "gene", "genes")}.`,
  not_common: (missing: number) =>
    ` It lacks ${counted(missing, "gene", "genes")} that the kept one has.`,
  further_genes: (count: number) => `${counted(count, "further gene", "further genes")}`,
  genes_left_out: (count: number) => `and ${with_separators(count)} more, which the downloaded file contains`,

  // ---- problems ----
  wrong_line: (line: number, got: string, allowed: string) =>
    `line ${with_separators(line)}: got "${got}", allowed: ${allowed}`,
  not_csv: (line: number) => `line ${with_separators(line)}: a cell in quotation marks does not end as it must`,
  heading: "a heading with island, organism and the name of each gene once, in any order",
  row: (genes: number, allowed: number, got: number) =>
    `an island, an organism and ${counted(genes, "gene", "genes")}, so ${allowed} cells, not ${got}` +
    (got > allowed ? "; decimal commas need semicolons or tabs between the cells" : ""),
  cell: (column: string, choices: readonly string[]) =>
    `${column === "island" || column === "organism" ? "a whole number" : "a number"}${
      choices.length > 0 ? `, or one of ${choices.join(", ")}` : ""} (column ${column})`,
  no_organism: "there is no organism in it",
  of_file: (file: string, problem: string) => `${file}: ${problem}.`,
  file_too_large: (bytes: number, bytes_max: number) =>
    `got ${with_separators(bytes)} bytes, allowed at most ${with_separators(bytes_max)}`,
  too_short: "The generations are too short to read a whole one. Pause the world first, or show an earlier " +
    "generation in the time line.",
  incomplete: (world: string) => `The server's answer about the population of ${world} is incomplete.`,
  gone: (name: string) => `${name} is no longer kept: another tab may have deleted it.`,
  forbidden: (why: string) => `This browser does not let the page store anything${why ? `: ${why}` : ""}.`,
  browser_full: "This browser has no more room for this page: download what you need as files, then delete it here.",
  too_many: (most: number) =>
    `The freezer is full: it has ${with_separators(most)} entries, the most allowed. Delete some first.`,
  full: (bytes: number, free: number, most: number) =>
    `The freezer is full: the genes need ${mebibytes(bytes)} MiB, and ${mebibytes(free)} of ${mebibytes(most)} ` +
    "MiB are free. Download and delete some entries first.",
};
