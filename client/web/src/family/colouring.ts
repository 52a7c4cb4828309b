// Colouring: the colours of the organisms of a tree by lineage, fitness or gene, and what they mean. No DOM.
import {Families, FamilyColours, no_founder} from "../render/families";
import {css, ramp_at, unknown} from "../render/look";
import type {GeneTable} from "./gene_table";
import type {Ancestor} from "./lineage";
import type {FamilyTree} from "./spot";
import {founders_of} from "./tree";

/** What the colours show. */
export type ColourBy =|{kind: "nothing"}|{kind: "lineage"}|{kind: "fitness"}|{
  kind: "gene";
  gene: number; // its index
};

/** The meaning of the colours: a few lineages, or the ends of a scale. */
export type Legend =|{kind: "nothing"}|{
  kind: "lineages";
  lineages: {founder: Ancestor; count: number; colour: string}[]; // roots of each, the largest lineage first
  others: {lineages: number; count: number};
}
|{
  kind: "scale";
  least: number;
  most: number;
  unknown: number; // organisms without a value
};

export interface Colouring {
  legend: Legend;
  colours: string[][]|null; // of each place of each row; null: all alike
  /** The founder of an organism; null if the colours show no lineages, or its line begins later. */
  founder_of(row: number, place: number): Ancestor|null;
}

const palette = "viridis";

/** The colours of a scale from its least to its most number, as a CSS gradient. */
export const scale_gradient =
  `linear-gradient(to right, ${[0, 0.25, 0.5, 0.75, 1].map((share) => css(ramp_at(palette, share))).join(", ")})`;

export function colouring_of(tree: FamilyTree, by: ColourBy, genes: GeneTable): Colouring {
  const no_founder_known = (): null => null;
  switch (by.kind) {
    case "nothing":
      return {legend: {kind: "nothing"}, colours: null, founder_of: no_founder_known};
    case "lineage":
      return by_lineage(tree);
    case "fitness":
      return by_number(tree, (ancestor) => ancestor.fitness ?? NaN);
    case "gene":
      return by_number(tree, (ancestor) => genes.value(ancestor, by.gene));
  }
}

function by_lineage(tree: FamilyTree): Colouring {
  const founders = founders_of(tree), roots = founders[founders.length - 1]!;
  const families = new Families(Uint32Array.from(roots, (founder) => founder < 0 ? no_founder : founder));
  const colours = new FamilyColours();
  colours.update(families);
  const of_founder = new Map(families.shown.map(({founder}, i) => [founder, css(colours.of(i))]));
  const coloured = families.shown.reduce((sum, {size}) => sum + size, 0);
  return {
    colours: founders.map((row) => Array.from(row, (founder) => of_founder.get(founder) ?? css(unknown))),
    founder_of: (row, place) => tree.rows[0]![founders[row]![place]!]?.ancestor ?? null,
    legend: {
      kind: "lineages",
      lineages: families.shown.map(
        ({founder, size}) =>
          ({founder: tree.rows[0]![founder]!.ancestor, count: size, colour: of_founder.get(founder)!})),
      others: {lineages: families.count - families.shown.length, count: roots.length - coloured},
    },
  };
}

function by_number(tree: FamilyTree, value_of: (ancestor: Ancestor) => number): Colouring {
  const values = tree.rows.map((row) => Float64Array.from(row, ({ancestor}) => value_of(ancestor)));
  let least = Infinity, most = -Infinity, missing = 0;
  for (const value of values.flatMap((row) => [...row])) {
    missing += Number.isNaN(value) ? 1 : 0;
    least = Math.min(least, Number.isNaN(value) ? Infinity : value);
    most = Math.max(most, Number.isNaN(value) ? -Infinity : value);
  }
  const share = (value: number): number => most > least ? (value - least) / (most - least) : 0.5 + 0 * value;
  return {
    colours: values.map((row) => Array.from(row, (value) => css(ramp_at(palette, share(value))))),
    founder_of: () => null,
    legend: {kind: "scale", least, most, unknown: missing},
  };
}
