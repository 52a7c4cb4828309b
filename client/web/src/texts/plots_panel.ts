// plots_panel: the panel "Plots" and its plots over generations.
import {shown_number, three_digits, with_separators} from "./numbers";

const round = (births: boolean): string => (births ? "interval" : "generation");

export const quantity_texts = {
  population: "Population",
  phase: "Phase plot",
  fitness: "Fitness",
  genes: "Genes",
  selection: "Selection",
  diversity: "Diversity",
  survivors: "Survivors",
  deaths: "Deaths",
  food: "Food"
};

export const figure_texts = {
  generation: "generation",
  interval: "interval",
  series_of: (series: string, history: string) => `${series}, ${history}`,
  deviation: "± 1 standard deviation",
  fitness: {
    title: "Fitness",
    y: "fitness",
    children: "children",
    best: "best",
    mean: "mean",
    median: "median",
    worst: "worst"
  },
  genes: {
    title: "Means of the genes",
    of_one: (gene: string) => `Gene ${gene}`,
    y: "gene units",
    y_of_weights: "weight",
    mean: "mean",
    greatest: "greatest",
    least: "least"
  },
  selection: {
    title: "Selection of the genes",
    of_one: (gene: string) => `Causes of change in the mean of ${gene}`,
    y: (births: boolean) => `gene units per ${round(births)}`,
    y_of_weights: (births: boolean) => `weight per ${round(births)}`,
    change: "change",
    selection: "selection",
    transmission: "transmission",
    migration: "migration"
  },
  diversity: {title: "Diversity", y: "mean standard deviation, as a share of the gene's range", diversity: "diversity"},
  survivors: {title: "Alive at the end", y: "organisms", alive: "alive at the end", born: "born"},
  deaths: {
    title: "Causes of death",
    y: "organisms",
    starved: "starved",
    poisoned: "poisoned",
    eaten: "eaten by predators",
    old: "of old age",
    alive: "alive at the end"
  },
  population: {
    title: "Population",
    y: "living organisms",
    prey: "prey, mean",
    prey_lowest: "prey, fewest",
    predators: "predators, mean",
    predators_lowest: "predators, fewest"
  },
  food: {
    title: "Food and poison eaten",
    y: (births: boolean) => `items per ${round(births)}`,
    food: "food eaten",
    poison: "poison eaten"
  },
  values: {title: (gene: string) => `Values of ${gene}`, y: "organisms", organisms: "organisms", none: "…"},
  all_died: (generation: number) => `generation ${generation}: all organisms died before its end`,
  extinction: "all died",
  phase: {
    title: "Prey and predators",
    prey: "living prey, mean",
    predators: "living predators, mean",
    newest: (generation: number, prey: number, predators: number, births: boolean) =>
      `Circle: ${round(births)} ${with_separators(generation)}, ${three_digits(prey)} prey, ${
        three_digits(predators)} predators. The line leads there; its older parts are paler.`,
  },
};

export const plots_panel_texts = {
  title: "Plots",
  quantity: "Quantity",
  island: "Island",
  all_islands: "all islands",
  island_name: (island: number) => `island ${island}`,
  running_mean: "Running mean",
  running_mean_help: "Running mean: each point is the mean of that generation and the ones before it. " +
    "Pale lines show each generation.",
  each_generation: "each generation",
  species: "Species",
  prey: "prey",
  predators: "predators",
  fit: "Fit",
  fit_help: "Shows all generations.",
  save_csv: "Save CSV",
  save_csv_help: "Saves the history of all islands as a table.",
  save_png: "Save PNG",
  save_png_help: (width: number, height: number) => `Saves the plot as an image of ${width} × ${height} pixels.`,
  known: (count: number, last: number, births: boolean) =>
    `${with_separators(count)} ${round(births)}${count === 1 ? "" : "s"}, up to ${shown_number(last)}`,
  none_ended: (births: boolean) => `No ${round(births)} has ended yet`,
  from_second: (births: boolean) => `Known from the second ${round(births)} on`,
  loading: "…",
  selection_of_all: "Price equation: by how much selection changed the mean of each gene. " +
    "Above 0, organisms with more of it had more offspring.",
  selection_of_one: "Price equation: the change of the mean is selection (which organisms had offspring) + " +
    "transmission (crossover and mutation) + migration.",

  compare: "compare with",
  nothing: "nothing",
  open_file: "CSV file …",
  open_file_help:
    "Compares with the statistics in a CSV file of this computer. You can also drop the file on the panel. " +
    "The file does not leave the browser.",
  compared_file: (file: string) => `Dashed: ${file}`,
  run: "Run of the file",
  remove: "Remove",
  remove_help: (file: string) => `Removes ${file} from the plots`,

  gene: "Gene",
  group: "Group of genes",
  genes_of: (group: string) => `genes: ${group}`,
  body: "body",
  brain: "brain",
  free: "free",
  most_changed: (count: number) => `means of the ${count} most changed`,
  most_selected: (count: number) => `selection of the ${count} most changed`,
  means_of_group: "means of all of the group",
  selection_of_group: "selection of all of the group",
  means_of_all: "means of all genes",
  selection_of_genes: "selection of all genes",
  organisms_of: (generation: number) => `All organisms of generation ${with_separators(generation)}`,
  organisms_of_island: (generation: number, island: number) =>
    `All organisms of generation ${with_separators(generation)}, island ${island}`,
};
