// Organism panel: one organism: its life, why it exists, its network, its genes and its offspring. Without a selection
// it offers the five healthiest organisms.
import {genes_of} from "../organism/genes";
import {axis_end} from "../organism/health";
import {distinct_parents, OrganismHistory, OrganismPlace} from "../organism/history";
import {
  child_text,
  choice_text,
  fate_text,
  gene_label,
  gene_number,
  parents_text,
  picks_text,
  range_text
} from "../organism/texts";
import {duration, tenths, three_digits, with_separators} from "../texts/numbers";
import {h, set_text, svg} from "../widgets/dom";

import type {ViewedWorld} from "../world/world";
import {BrainView} from "./brain_view";
import type {Panel, PanelContext} from "../world/panel_context";
import {Width} from "./width";

const offered_max = 5;
const offer_interval_ms = 1000; // the list of the healthiest does not change faster, so that it can be clicked
const retry_after_ms = 5000; // after a refused request
const children_shown_max = 40;
const free_genes_open_max = 12;
const curve = {
  width: 368,
  height: 64
};

export class OrganismPanel implements Panel {
  readonly name = "organism";
  readonly title = "Organism";
  readonly element: HTMLElement;

  #history: OrganismHistory|null = null;
  #release_population: (() => void)|null = null;
  #pending = false; // a GetBreeding is on its way
  #retry_at_ms = 0;
  #problem = ""; // why the picks are unknown
  #offered_at_ms = -Infinity;
  #offer_timer = 0;
  #drawn: unknown[] = [];
  #gene_key = "";
  #gene_bars: GeneBar[] = [];
  #parents_key = "";
  #children_key = "";

  // ---- elements ----
  readonly #offers = Array.from(
    {length: offered_max},
    (_, i) => h("button", {class: "button organism-offer", onclick: () => this.#choose_offer(i)}));
  #offered: number[] = [];
  readonly #waiting = h("p", {class: "hint"});
  readonly #choice = h(
    "div", {class: "panel"},
    h("p", {}, "Click an organism to inspect it: its genes, its parents and why they were picked."),
    h("h3", {}, "The healthiest organisms now"), h("div", {class: "organism-offers"}, ...this.#offers), this.#waiting);
  readonly #heading = h("h2", {});
  readonly #back =
    h("button", {
      class: "button",
      title: "Returns to the live world.",
      onclick: () => this.#act((world) => world.past.back_to_live())
    },
      "Back to live");
  readonly #another = h("button", {class: "button", onclick: () => this.#forget()}, "Deselect");
  readonly #family = h("button", {class: "button", onclick: () => this.#open_family()}, "Family tree");
  readonly #fate = h("p", {class: "organism-fate"});
  readonly #action = h("p", {});
  readonly #follow: HTMLInputElement =
    h("input", {type: "checkbox", onchange: () => this.#context.world().selection.set_follow(this.#follow.checked)});
  readonly #follow_row = h("label", {class: "check"}, this.#follow, "keep it centred");
  readonly #eaten = h("p", {});
  readonly #body = h("p", {});
  readonly #parents = h("p", {});
  readonly #parent_rows = h("div", {class: "organism-parents"});
  readonly #own_picks = h("p", {});
  readonly #show_picks = h("button", {class: "button", onclick: () => this.#open_own_picks()}, "Show its picks");
  readonly #picks_problem = h("p", {class: "error", role: "status"});
  readonly #health_line = svg("polyline", {class: "organism-health-line"});
  readonly #health_svg = svg(
    "svg",
    {class: "organism-health", viewBox: `0 0 ${curve.width} ${curve.height}`, preserveAspectRatio: "none", role: "img"},
    this.#health_line);
  readonly #health_axis = h("h3", {});
  readonly #health_since = h("p", {class: "hint"});
  readonly #brain = new BrainView();
  readonly #brain_part = h("section", {class: "panel organism-part"}, h("h3", {}, "Network"), this.#brain.element);
  readonly #genes = h("div", {class: "organism-genes"});
  readonly #genes_heading = h("h3", {}, "Genes");
  readonly #genes_hint = h("p", {class: "hint"});
  readonly #free_genes = h("div", {class: "organism-free-genes"});
  readonly #free_summary = h("summary", {});
  readonly #free_part = h("details", {}, this.#free_summary, this.#free_genes);
  readonly #offspring = h("h3", {}, "Offspring");
  readonly #children = h("div", {class: "organism-children"});
  readonly #details =
    h("div", {class: "panel"}, h("div", {class: "row organism-head"}, this.#heading, this.#back), this.#fate,
      this.#action, h("div", {class: "row"}, this.#follow_row, this.#family, this.#another),
      h("div", {}, this.#eaten, this.#body),
      h("section", {class: "panel organism-part"}, h("h3", {}, "Why it exists"), this.#parent_rows, this.#parents,
        this.#own_picks, h("div", {class: "row"}, this.#show_picks), this.#picks_problem),
      h("section", {class: "panel organism-part"}, this.#health_axis, this.#health_svg, this.#health_since),
      this.#brain_part,
      h("section", {class: "panel organism-part"}, this.#genes_heading, this.#genes, this.#genes_hint, this.#free_part),
      h("section", {class: "panel organism-part"}, this.#offspring, this.#children));

  readonly #width: Width;

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    this.element = h("div", {class: "panel organism"}, this.#choice, this.#details);
    this.#width = new Width(this.element, () => this.refresh());
  }

  refresh(): void {
    const world = this.#context.world();
    this.#take(world);
    const history = this.#history;
    this.#choice.hidden = history !== null;
    this.#details.hidden = history === null;
    if (history) {
      this.#request(world, history);
      this.#show_life(world, history);
      this.#show_picks_of(history, world);
      this.#show_offspring(world, history);
      const drawn = [history, history.info, history.ranges, world.gene_names.length, this.#width.within(280, 560)];
      // snapshots arrive more often than answers about the organism
      if (drawn.some((part, i) => part !== this.#drawn[i])) {
        this.#drawn = drawn;
        this.#show_health(history);
        this.#show_brain(world, history);
        this.#show_genes(world, history);
      }
    } else {
      this.#offer(world);
    }
  }

  // ---- which organism, and what is known about it ----

  /** Follows the selection. An organism stays in the panel when its generation ends, until another one is selected. */
  #take(world: ViewedWorld): void {
    const snapshot = world.snapshot;
    if (!snapshot) {
      this.#forget_history();
      return;
    }
    const known = this.#history?.place ?? null;
    const here = known !== null && known.run_id === snapshot.run_id && known.island === world.island;
    if (world.selection.id === null) {
      if (!here || known.generation === snapshot.generation) {
        this.#forget_history();
      }
    } else {
      // Around the end of a generation, an answer about the same id may already be about the next one, so the snapshot
      // counts.
      const place: OrganismPlace =
        {run_id: snapshot.run_id, island: world.island, id: world.selection.id, generation: snapshot.generation};
      if (!here || known.id !== place.id || known.generation !== place.generation) {
        this.#forget_history();
        this.#history = new OrganismHistory(place);
      }
    }
    const history = this.#history;
    if (!history) {
      return;
    }
    history.ended = snapshot.generation !== history.place.generation;
    if (world.selection.info && !history.ended) {
      history.add_info(world.selection.info);
    }
    if (world.population.columns) {
      history.add_population(world.population.columns);
    }
    const needs_population = history.ranges.length === 0 && !history.ended;
    if (needs_population && !this.#release_population) {
      this.#release_population = world.population.need();
    } else if (!needs_population) {
      this.#release_population?.();
      this.#release_population = null;
    }
  }

  #forget_history(): void {
    this.#release_population?.();
    this.#release_population = null;
    this.#history = null;
    this.#problem = "";
    this.#retry_at_ms = 0;
  }

  #forget(): void {
    this.#forget_history();
    this.#context.world().selection.select(null);
    this.#offered_at_ms = -Infinity;
    this.refresh();
    this.#offers[0]!.focus();
  }

  /** Whether the organism's own generation has bred: a later one is shown, or stored in the replay. */
  #has_bred(world: ViewedWorld, history: OrganismHistory): boolean {
    const newest = Math.max(world.snapshot?.generation ?? 0, Number(world.info?.replay?.last_generation ?? 0));
    return newest > history.place.generation;
  }

  #request(world: ViewedWorld, history: OrganismHistory): void {
    const fields = history.wanted(this.#has_bred(world, history));
    if (!fields || this.#pending || performance.now() < this.#retry_at_ms) {
      return;
    }
    this.#pending = true;
    world.server.request("get_breeding", {world: world.shown, ...fields})
      .then(
        (breeding) => {
          history.add_breeding(fields, breeding);
          this.#problem = "";
        },
        (error: Error) => {
          if (history === this.#history) {
            this.#problem = error.message;
          }
          this.#retry_at_ms = performance.now() + retry_after_ms;
        })
      .finally(() => {
        this.#pending = false;
        this.refresh();
      });
  }

  // ---- the choice without a selection ----

  #offer(world: ViewedWorld): void {
    set_text(
      this.#waiting,
      world.feed.healthiest.length > 0 ? "" :
        world.snapshot                 ? "No organism is alive." :
                                         "Waiting for the first snapshot …");
    const due_ms = this.#offered_at_ms + offer_interval_ms - performance.now();
    if (due_ms > 0 && this.#offered.length > 0) {
      if (this.#offer_timer === 0) {
        this.#offer_timer = setTimeout(() => {
          this.#offer_timer = 0;
          this.refresh();
        }, due_ms);
      }
      return;
    }
    this.#offered_at_ms = performance.now();
    this.#offered = world.feed.healthiest.slice(0, offered_max).map((organism) => organism.id);
    this.#offers.forEach((button, i) => {
      const organism = world.feed.healthiest[i];
      button.hidden = organism === undefined;
      if (organism) {
        set_text(button, `Organism ${organism.id}, health ${three_digits(organism.health)}`);
      }
    });
  }

  #choose_offer(index: number): void {
    const id = this.#offered[index];
    if (id !== undefined) {
      this.#context.world().selection.select(id);
      this.refresh();
    }
  }

  // ---- its parts ----

  #show_life(world: ViewedWorld, history: OrganismHistory): void {
    const {id, generation} = history.place;
    set_text(this.#heading, `Organism ${id} of generation ${with_separators(generation)}`);
    this.#back.hidden = !world.is_replay;
    const info = history.info;
    set_text(this.#fate, info ? fate_text(history) : "Loading …");
    this.#fate.classList.toggle("dead", history.dead);
    const acts = info !== null && !history.dead && !history.ended;
    set_text(this.#action, acts ? choice_text(info) : "");
    this.#action.hidden = !acts;
    this.#follow_row.hidden = !acts;
    this.#follow.checked = world.selection.follow;
    set_text(
      this.#eaten,
      info ? `eaten: ${with_separators(info.food_eaten ?? 0)} food, ${with_separators(info.poison_eaten ?? 0)} poison` :
             "");
    set_text(
      this.#body, info ? `radius ${tenths(info.radius_px ?? 0)} px, mass ${(info.mass_kg ?? 0).toFixed(2)} kg` : "");
    this.#family.hidden = info === null;
  }

  #show_picks_of(history: OrganismHistory, world: ViewedWorld): void {
    const info = history.info;
    const parents = distinct_parents(info);
    const key = parents.map((parent) => `${parent}:${history.picks_of_parent(parent) !== null}`).join() + this.#problem;
    if (key !== this.#parents_key) {
      this.#parents_key = key;
      this.#parent_rows.replaceChildren(...parents.map((parent) => this.#parent_row(history, parent)));
    }
    set_text(
      this.#parents,
      info ?
        [
          parents_text(info, history.origin) + ".", ...parents.flatMap((parent) => {
            const picks = history.picks_of_parent(parent);
            return picks ? [picks_text(`Its parent ${parent}`, picks)] : [];
          })
        ].join(" ") :
        "");
    set_text(this.#own_picks, history.picks ? picks_text("It", history.picks) : "");
    this.#own_picks.hidden = history.picks === null;
    this.#show_picks.disabled = history.picks === null;
    this.#show_picks.title = history.picks ? "Opens the glass box at its first pick." :
      !this.#has_bred(world, history)      ? "Its generation has not bred yet." :
      this.#pending                        ? "Loading …" :
                                             "Its picks are unknown.";
    set_text(this.#picks_problem, this.#problem ? `The picks are unknown: ${this.#problem}.` : "");
  }

  #parent_row(history: OrganismHistory, parent: number): HTMLElement {
    const picks = history.picks_of_parent(parent);
    const {generation, island} = history.place;
    // Only the picks contain whether the parent is a copy of an organism of another island.
    const place = picks?.migrant ?? {island, organism: parent};
    return h(
      "div", {class: "row"},
      h("button", {
        class: "button",
        disabled: picks === null && this.#problem === "",
        title: "Shows the parent alive, in a replay of its generation.",
        onclick: () => this.#go_to(generation - 1, place.island, place.organism),
      },
        `Go to parent ${parent}`),
      h("button", {
        class: "button",
        disabled: picks === null,
        title: "Opens the glass box at the first pick of this parent.",
        onclick: () => this.#context.open("glass box", {generation: generation - 1, island, organism: parent}),
      },
        `Why ${parent}?`));
  }

  #show_health(history: OrganismHistory): void {
    const points = history.health;
    const last = points[points.length - 1];
    const most = axis_end(points.reduce((highest, point) => Math.max(highest, point.health), 1));
    set_text(this.#health_axis, `Health, axis from 0 to ${three_digits(most)}`);
    const first_s = points[0]?.s ?? 0, span_s = Math.max((last?.s ?? 0) - first_s, 1e-9);
    const x_of = (s: number): number => (s - first_s) / span_s * curve.width;
    const y_of = (health: number): number => curve.height - 1 - health / most * (curve.height - 2);
    const drawn = points.length === 1 ? [points[0]!, {...points[0]!, s: first_s + span_s}] : points;
    const places = drawn.map((point) => `${x_of(point.s).toFixed(1)},${y_of(point.health).toFixed(1)}`);
    this.#health_line.setAttribute("points", places.join(" "));
    this.#health_svg.setAttribute(
      "aria-label",
      last ? `Health since you selected it: from ${tenths(points[0]!.health)} to ${tenths(last.health)}` :
             "Health: unknown");
    set_text(
      this.#health_since,
      points.length > 1 ? `since you selected it, ${duration(last!.s - first_s)} ago` : "since you selected it");
  }

  #show_brain(world: ViewedWorld, history: OrganismHistory): void {
    const genes: number[] = history.info?.genes ?? [];
    const weights = genes_of(world.feed.gene_groups, "brain", genes.length);
    const width = this.#width.within(280, 560);
    this.#brain_part.hidden = !history.brain ||
      !this.#brain.update(history.brain, genes.slice(weights.first, weights.first + weights.count), width);
  }

  #show_genes(world: ViewedWorld, history: OrganismHistory): void {
    const names = world.gene_names;
    const genes: number[] = history.info?.genes ?? [];
    const weights = genes_of(world.feed.gene_groups, "brain", names.length);
    const free = genes_of(world.feed.gene_groups, "free", names.length);
    const bars =
      names.map((_, gene) => gene)
        .filter(
          (gene) => gene < genes.length && !(gene >= weights.first && gene < weights.first + weights.count) &&
            !(gene >= free.first && gene < free.first + free.count));
    const key = `${history.place.run_id}/${names.join()}/${genes.length}`;
    if (key !== this.#gene_key) {
      this.#gene_key = key;
      this.#gene_bars = bars.map((gene) => new GeneBar(gene, gene_label(names[gene]!)));
      this.#genes.replaceChildren(...this.#gene_bars.map((bar) => bar.element));
      this.#free_genes.replaceChildren();
      this.#free_part.open = free.count <= free_genes_open_max;
    }
    for (const bar of this.#gene_bars) {
      bar.update(genes[bar.gene]!, history.ranges[bar.gene] ?? null);
    }
    set_text(
      this.#genes_hint,
      history.ranges.length > 0 ? "Bar: from the least to the greatest value in this generation. Line: the mean." : "");
    this.#free_part.hidden = free.count === 0 || genes.length < free.first + free.count;
    if (!this.#free_part.hidden) {
      set_text(this.#free_summary, `${with_separators(free.count)} free genes, which the simulation does not read`);
      for (let i = 0; i < free.count; ++i) {
        const item = this.#free_genes.children[i] ?? this.#free_genes.appendChild(h("span", {}));
        set_text(item, `${gene_label(names[free.first + i]!)} ${gene_number(genes[free.first + i]!)}`);
      }
    }
  }

  #show_offspring(world: ViewedWorld, history: OrganismHistory): void {
    const children = history.children;
    const next = history.place.generation + 1;
    const key = `${next}/${children?.length}/${history.children_left_out}/${this.#has_bred(world, history)}`;
    if (key === this.#children_key) {
      return;
    }
    this.#children_key = key;
    set_text(
      this.#offspring,
      children && children.length > 0 ?
        `Offspring in generation ${with_separators(next)}: ${with_separators(children.length)}` :
        "Offspring");
    const text = !this.#has_bred(world, history) ? "Offspring appear when the next generation starts." :
      history.children_left_out                  ? "Offspring unknown: the next generation is too large to search it." :
      !children                                  ? "Loading …" :
      children.length === 0                      ? "none" :
                                                   "";
    const buttons = (children ?? [])
                      .slice(0, children_shown_max)
                      .map(
                        (child) =>
                          h("button", {
                            class: "button organism-child",
                            title: `Shows organism ${child.id} of generation ${next}.`,
                            onclick: () => this.#go_to(next, history.place.island, child.id),
                          },
                            child_text(child)));
    const more = (children?.length ?? 0) - buttons.length;
    this.#children.replaceChildren(
      ...buttons, h("span", {class: "hint"}, text || (more > 0 ? `and ${with_separators(more)} more` : "")));
  }

  // ---- actions ----

  #act(what: (world: ViewedWorld) => Promise<void>): void {
    void this.#context.attempt(() => what(this.#context.world()));
  }

  #go_to(generation: number, island: number, organism: number): void {
    this.#act(async (world) => {
      if (world.snapshot?.generation !== generation || world.island !== island) {
        await world.past.show(generation);
        if (world.island !== island) {
          world.choose_island(island);
        }
      }
      world.selection.select(organism);
      world.selection.set_follow(true);
    });
  }

  #open_own_picks(): void {
    if (this.#history) {
      const {generation, island, id} = this.#history.place;
      this.#context.open("glass box", {generation, island, organism: id});
    }
  }

  #open_family(): void {
    if (this.#history) {
      const {generation, island, id} = this.#history.place;
      this.#context.open("family", {generation, island, organism: id});
    }
  }
}

/** A gene as a bar between the least and the greatest value in the generation, with a line at the mean. */
class GeneBar {
  readonly element: HTMLElement;
  readonly #value = h("span", {class: "gene-value"});
  readonly #fill = h("div", {class: "gene-fill"});
  readonly #mean = h("div", {class: "gene-mean"});
  readonly #bar = h("div", {class: "gene-bar", role: "meter"}, this.#fill, this.#mean);

  constructor(readonly gene: number, label: string) {
    this.#bar.setAttribute("aria-label", label);
    this.element = h("div", {class: "gene"}, h("span", {class: "gene-name"}, label), this.#value, this.#bar);
  }

  update(value: number, range: {min: number; mean: number; max: number}|null): void {
    set_text(this.#value, gene_number(value));
    this.#bar.hidden = range === null;
    if (!range) {
      return;
    }
    const share = (of: number): number =>
      range.max > range.min ? Math.min(1, Math.max(0, (of - range.min) / (range.max - range.min))) : 0.5;
    this.#fill.style.width = `${(100 * share(value)).toFixed(1)}%`;
    this.#mean.style.left = `${(100 * share(range.mean)).toFixed(1)}%`;
    this.element.title = range_text(range);
    this.#bar.setAttribute("aria-valuemin", range.min.toFixed(2));
    this.#bar.setAttribute("aria-valuemax", range.max.toFixed(2));
    this.#bar.setAttribute("aria-valuenow", value.toFixed(2));
    this.#bar.setAttribute("aria-valuetext", `${gene_number(value)}. ${range_text(range)}`);
  }
}
