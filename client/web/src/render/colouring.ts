// Colouring: the colour of each organism, by its health, its lineage or a gene. The colours are computed again only
// after a change of the snapshot, of the population or of the look.
import type {Drawing, Look, PopulationColumns} from "../core/messages";
import {steps_per_px} from "../core/snapshot";
import {Families, FamilyColours} from "./families";
import type {KeptSnapshot} from "./interpolator";
import {css, packed, ScaleTable, unknown} from "./look";

/** What the colours depend on. The versions change with the objects. */
export interface ColouringInput {
  look: Look;
  latest: KeptSnapshot;
  snapshot_version: number;
  population: PopulationColumns|null; // of the generation and the island of the snapshot
  population_version: number;
  health_max: number;
}

export class Colouring {
  /** Packed colours by row of the snapshot; null: no colouring. */
  colours: Int32Array|null = null;
  version = 0; // changes with `colours`
  /** The range of the gene by which the organisms are coloured. */
  gene_range: [number, number]|null = null;
  #key = "";
  #families: Families|null = null;
  #families_version = -1;
  readonly #family_colours = new FamilyColours();

  update(input: ColouringInput): void {
    const {look, latest, snapshot_version, population, population_version, health_max} = input;
    const key = look.colour_by === "" ?
      "" :
      [snapshot_version, population_version, look.colour_by, look.palette, health_max].join(" ");
    if (key === this.#key) {
      return;
    }
    this.#key = key;
    ++this.version;
    this.gene_range = null;
    if (look.colour_by === "") {
      this.colours = null;
      return;
    }
    if (this.colours === null || this.colours.length < latest.count) {
      this.colours = new Int32Array(Math.max(latest.count, 2 * (this.colours?.length ?? 0)));
    }
    if (look.colour_by === "health") {
      this.#colour_by_health(input, this.colours);
    } else if (look.colour_by === "lineage") {
      this.#colour_by_lineage(input, this.colours);
    } else {
      this.#colour_by_gene(look, latest, population, this.colours);
    }
  }

  /** A text that changes with the legend of the colours. */
  get legend_key(): string {
    return this.#key === "" ? "" : `${this.gene_range} ${this.#families_version}`;
  }

  /** The entries of the legend if lineages are shown. */
  lineages(population: PopulationColumns|null): Pick<Drawing, "lineages"|"lineage_others"> {
    const families = population === null ? null : this.#families;
    if (families === null) {
      return {lineages: null, lineage_others: null};
    }
    return {
      lineages:
        families.shown.map(({founder, size}, i) => ({founder, count: size, colour: css(this.#family_colours.of(i))})),
      lineage_others: {
        lineages: families.count - families.shown.length,
        count: families.size - families.shown.reduce((sum, {size}) => sum + size, 0),
        placed: (population?.founders?.length ?? 0) - families.size
      },
    };
  }

  #colour_by_health({look, latest, health_max}: ColouringInput, colours: Int32Array): void {
    const scale = new ScaleTable(look.palette, 0, health_max);
    for (let i = 0; i < latest.count; ++i) {
      colours[i] = scale.at(latest.health[i]! / steps_per_px);
    }
  }

  #colour_by_lineage({latest, population, population_version}: ColouringInput, colours: Int32Array): void {
    if (this.#families_version !== population_version) {
      const founders = population?.founders ?? null;
      this.#families_version = population_version;
      this.#families = founders === null ? null : new Families(founders);
      if (this.#families !== null) {
        this.#family_colours.update(this.#families);
      }
    }
    const families = this.#families, grey = packed(unknown);
    for (let i = 0; i < latest.count; ++i) {
      colours[i] =
        families === null || population === null ? grey : packed(this.#family_colours.of(families.of(latest.id[i]!)));
    }
  }

  #colour_by_gene(look: Look, latest: KeptSnapshot, population: PopulationColumns|null, colours: Int32Array): void {
    const grey = packed(unknown), values = population?.genes[population.gene_names.indexOf(look.colour_by)];
    if (values === undefined) {
      colours.fill(grey);
      return;
    }
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    this.gene_range = values.length > 0 ? [low, high] : null;
    const scale = new ScaleTable(look.palette, low, high);
    for (let i = 0; i < latest.count; ++i) {
      const value = values[latest.id[i]!];
      colours[i] = value === undefined || Number.isNaN(value) ? grey : scale.at(value);
    }
  }
}
