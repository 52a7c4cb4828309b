// Organism panel: one organism: its life, why it exists, its network, its genes and its offspring. Without a selection
// it offers the five healthiest organisms.
import {genes_of} from "../organism/genes";
import {OrganismHistory} from "../organism/history";
import type {OrganismPlace} from "../organism/history";
import {organism_texts as texts} from "../texts/organism";
import {h} from "../widgets/dom";
import type {Panel, PanelContext} from "../world/panel_context";
import {origin_run_of} from "../world/origin";
import type {ViewedWorld} from "../world/world";
import {BrainView} from "./brain_view";
import {OrganismGenes} from "./organism_genes";
import {HealthCurve, OrganismLife} from "./organism_life";
import {OrganismOffers} from "./organism_offers";
import {OrganismOffspring, OrganismOrigin} from "./organism_origin";
import type {OriginContext} from "./organism_origin";
import {Width} from "./width";

const retry_after_ms = 5000; // after a refused request

export class OrganismPanel implements Panel {
  readonly name = "organism";
  readonly title = texts.title;
  readonly element: HTMLElement;
  readonly #context: PanelContext;
  readonly #offers: OrganismOffers;
  readonly #life: OrganismLife;
  readonly #health = new HealthCurve();
  readonly #origin: OrganismOrigin;
  readonly #offspring: OrganismOffspring;
  readonly #brain = new BrainView();
  readonly #brain_part = h("section", {class: "panel organism-part"}, h("h3", {}, texts.network), this.#brain.element);
  readonly #genes = new OrganismGenes();
  readonly #details: HTMLElement;
  readonly #width: Width;
  #history: OrganismHistory|null = null;
  #release_population: (() => void)|null = null;
  #pending = false; // a GetBreeding is on its way
  #retry_at_ms = 0;
  #problem = ""; // why the picks are unknown
  #origin_run = ""; // id of the run in which the parents bred, if the shown world is a fork of it
  #drawn: unknown[] = [];

  constructor(context: PanelContext) {
    this.#context = context;
    this.#offers = new OrganismOffers((id) => {
      context.world().selection.select(id);
      this.refresh();
    }, () => this.refresh());
    this.#life = new OrganismLife({
      back_to_live: () => void context.attempt(() => context.world().past.back_to_live()),
      deselect: () => this.#deselect(),
      open_family: () => this.#open_family(),
      set_follow: (follow) => context.world().selection.set_follow(follow),
    });
    const breeding: OriginContext = {
      has_bred: () => this.#history !== null && has_bred(context.world(), this.#history),
      is_loading: () => this.#pending,
      problem: () => this.#problem,
      origin_run: () => this.#origin_run,
      go_to: (generation, island, organism) => this.#go_to(generation, island, organism),
      open_picks: (generation, island, organism) => context.open("glass box", {generation, island, organism}),
    };
    this.#origin = new OrganismOrigin(context, breeding);
    this.#offspring = new OrganismOffspring(breeding);
    this.#details =
      h("div", {class: "panel"}, ...this.#life.elements, this.#origin.element, this.#health.element, this.#brain_part,
        this.#genes.element, this.#offspring.element);
    this.element = h("div", {class: "panel organism"}, this.#offers.element, this.#details);
    this.#width = new Width(this.element, () => this.refresh());
  }

  refresh(): void {
    const world = this.#context.world();
    this.#follow(world);
    const history = this.#history;
    this.#offers.element.hidden = history !== null;
    this.#details.hidden = history === null;
    if (history === null) {
      this.#offers.update(world);
      return;
    }
    this.#request(world, history);
    this.#life.update(world, history);
    this.#origin.update(history);
    this.#offspring.update(history);
    const drawn = [history, history.info, history.ranges, world.gene_names.length, this.#width.within(560)];
    // snapshots arrive more often than answers about the organism
    if (drawn.some((part, i) => part !== this.#drawn[i])) {
      this.#drawn = drawn;
      this.#health.update(history);
      this.#show_brain(world, history);
      this.#genes.update(world, history);
    }
  }

  // ---- which organism, and what is known about it ----

  /** Follows the selection. An organism stays in the panel when its generation ends, until another one is selected. */
  #follow(world: ViewedWorld): void {
    const place = this.#place_to_show(world);
    const known = this.#history?.place;
    if (place === null) {
      this.#forget();
      return;
    }
    if (place !== known) {
      const before = this.#history;
      this.#forget();
      this.#history = new OrganismHistory(place, before);
    }
    const history = this.#history!;
    history.ended = world.snapshot!.generation !== history.place.generation;
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

  /** Returns which organism is to be shown: the place of the known one if it stays; null: none. */
  #place_to_show(world: ViewedWorld): OrganismPlace|null {
    const {snapshot, selection: {id: selected}, island} = world;
    if (snapshot === null) {
      return null;
    }
    const known = this.#history?.place;
    const here = known?.run_id === snapshot.run_id && known.island === island ? known : null;
    if (selected === null) {
      return here?.generation === snapshot.generation ? null : here;
    }
    // Around the end of a generation, an answer about the same id may already be about the next one, so the snapshot
    // counts.
    const {run_id, generation} = snapshot;
    return here?.id === selected && here.generation === generation ? here : {run_id, island, id: selected, generation};
  }

  #forget(): void {
    this.#release_population?.();
    this.#release_population = null;
    this.#history = null;
    this.#problem = this.#origin_run = "";
    this.#retry_at_ms = 0;
  }

  #deselect(): void {
    this.#forget();
    this.#context.world().selection.select(null);
    this.#offers.renew();
    this.refresh();
    this.#offers.focus();
  }

  #request(world: ViewedWorld, history: OrganismHistory): void {
    const fields = history.wanted(has_bred(world, history));
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
            const origin_run = origin_run_of(error);
            history.parents_bred_elsewhere ||= origin_run !== "";
            this.#origin_run ||= origin_run;
            this.#problem = origin_run === "" ? error.message : "";
          }
          this.#retry_at_ms = performance.now() + retry_after_ms;
        })
      .finally(() => {
        this.#pending = false;
        this.refresh();
      });
  }

  #show_brain(world: ViewedWorld, {info, brain}: OrganismHistory): void {
    const genes = info?.genes ?? [];
    const {first, count} = genes_of(world.feed.gene_groups, "brain", genes.length);
    this.#brain_part.hidden =
      !brain || !this.#brain.update(brain, genes.slice(first, first + count), this.#width.within(560));
  }

  // ---- actions ----

  #go_to(generation: number, island: number, organism: number): void {
    const world = this.#context.world();
    void this.#context.attempt(async () => {
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

  #open_family(): void {
    if (this.#history) {
      const {generation, island, id} = this.#history.place;
      this.#context.open("family", {generation, island, organism: id});
    }
  }
}

/** Whether the organism's own generation has bred: a later one is shown, or stored in the replay. */
function has_bred(world: ViewedWorld, {place}: OrganismHistory): boolean {
  const newest = Math.max(world.snapshot?.generation ?? 0, Number(world.info?.replay?.last_generation ?? 0));
  return newest > place.generation;
}
