// The legend of the colours of the organisms in the corner of the island.
import {shown_number, with_separators} from "./numbers";

export const island_legend_texts = {
  density: (side_px: number) => `organisms in ${shown_number(side_px)} × ${shown_number(side_px)} px`,
  health: "health, points",
  /** The gene's name with its unit: "food_radius, px". */
  gene: (name: string) => name +
    (name === "food_radius" || name === "poison_radius" ? ", px" :
       name.includes("<")                               ? "" :
                                                          ", gene units"),
  unknown_lineages: "lineages not known yet",
  lineages: "lineages, counted from generation 1",
  lineage: (founder: number, count: number) =>
    `descendants of organism ${with_separators(founder)}: ${with_separators(count)}`,
  smaller_lineages: (lineages: number, count: number) =>
    `${with_separators(lineages)} smaller lineages: ${with_separators(count)}`,
  placed: (count: number) => `placed by a user, and their descendants: ${with_separators(count)}`,
  food_radius: "perception radius for food",
  poison_radius: "perception radius for poison",
  networks: "steered by its network; an arrow of 30 px is 100 kg px/s²",
  seeks: "seeks food",
  flees: "flees from poison",
  flees_both: "flees from poison or a predator",
  wanders: "wanders; an arrow of 30 px is 100 kg px/s²",
};
