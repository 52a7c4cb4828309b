// OrganismLife: the life of the selected organism: its fate, its next action, its meals and its body; and its health as
// a curve.
import {axis_end} from "../organism/health";
import type {OrganismHistory} from "../organism/history";
import {choice_text, fate_text} from "../organism/texts";
import {organism_texts as texts} from "../texts/organism";
import {h, set_text, svg} from "../widgets/dom";
import {button, check, row} from "../widgets/form";
import type {ViewedWorld} from "../world/world";

const curve_width = 368, curve_height = 64;

/** What its buttons do. */
export interface LifeActions {
  back_to_live(): void;
  deselect(): void;
  open_family(): void;
  set_follow(follow: boolean): void;
}

export class OrganismLife {
  readonly #heading = h("h2", {});
  readonly #back: HTMLElement;
  readonly #family: HTMLElement;
  readonly #fate = h("p", {class: "organism-fate"});
  readonly #action = h("p", {});
  readonly #follow: HTMLInputElement;
  readonly #follow_row: HTMLElement;
  readonly #children = h("p", {});
  readonly #eaten = h("p", {});
  readonly #body = h("p", {});
  readonly elements: readonly HTMLElement[];

  constructor(actions: LifeActions) {
    this.#back = button(texts.back, () => actions.back_to_live(), {title: texts.back_help});
    this.#family = button(texts.family, () => actions.open_family());
    this.#follow = h("input", {type: "checkbox", onchange: () => actions.set_follow(this.#follow.checked)});
    this.#follow_row = check(this.#follow, texts.follow);
    const deselect = button(texts.deselect, () => actions.deselect());
    this.elements = [
      h("div", {class: "row organism-head"}, this.#heading, this.#back), this.#fate, this.#action,
      row(this.#follow_row, this.#family, deselect), h("div", {}, this.#children, this.#eaten, this.#body)
    ];
  }

  update(world: ViewedWorld, history: OrganismHistory): void {
    const {info, place} = history;
    const is_predator = info?.species === "SPECIES_PREDATOR";
    set_text(
      this.#heading,
      info?.number !== undefined ? texts.numbered(info.number, is_predator) :
        is_predator              ? texts.predator(place.id, place.generation) :
                                   texts.heading(place.id, place.generation));
    this.#back.hidden = !world.is_replay;
    set_text(this.#fate, info ? fate_text(history) : texts.loading);
    this.#fate.classList.toggle("dead", history.dead);
    const acts = info !== null && !history.dead && !history.ended;
    set_text(this.#action, acts ? choice_text(info) : "");
    this.#action.hidden = !acts;
    this.#follow_row.hidden = !acts;
    this.#follow.checked = world.selection.follow;
    set_text(
      this.#eaten,
      !info         ? "" :
        is_predator ? texts.eaten_prey(info.food_eaten ?? 0) :
                      texts.eaten(info.food_eaten ?? 0, info.poison_eaten ?? 0));
    set_text(this.#children, history.has_births ? texts.children(info?.children ?? 0) : "");
    set_text(this.#body, info ? texts.body(info.radius_px ?? 0, info.mass_kg ?? 0) : "");
    this.#family.hidden = info === null;
  }
}

export class HealthCurve {
  readonly #line = svg("polyline", {class: "organism-health-line"});
  readonly #svg = svg(
    "svg",
    {class: "organism-health", viewBox: `0 0 ${curve_width} ${curve_height}`, preserveAspectRatio: "none", role: "img"},
    this.#line);
  readonly #axis = h("h3", {});
  readonly #since = h("p", {class: "hint"});
  readonly element = h("section", {class: "panel organism-part"}, this.#axis, this.#svg, this.#since);

  update({health: points}: OrganismHistory): void {
    const first = points[0], last = points[points.length - 1];
    const most = axis_end(points.reduce((highest, point) => Math.max(highest, point.health), 1));
    set_text(this.#axis, texts.health_axis(most));
    this.#svg.setAttribute(
      "aria-label", first && last ? texts.health_curve(first.health, last.health) : texts.health_unknown);
    const lived_s = first && last ? last.s - first.s : 0, span_s = Math.max(lived_s, 1e-9);
    const x_of = (s: number): number => (s - (first?.s ?? 0)) / span_s * curve_width;
    const y_of = (health: number): number => curve_height - 1 - health / most * (curve_height - 2);
    const drawn = first && points.length === 1 ? [first, {...first, s: first.s + span_s}] : points;
    this.#line.setAttribute(
      "points", drawn.map((point) => `${x_of(point.s).toFixed(1)},${y_of(point.health).toFixed(1)}`).join(" "));
    set_text(this.#since, points.length > 1 ? texts.selected_ago(lived_s) : texts.selected);
  }
}
