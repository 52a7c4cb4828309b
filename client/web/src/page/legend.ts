// Legend: explains the marks of the island in one line: each mark as it is drawn, on the ground of the island, with its
// name.
import {legend_texts} from "../texts/column";
import {set_attribute} from "../widgets/controls";
import {h, set_text, svg} from "../widgets/dom";
import type {ViewedWorld} from "../world/world";

type Mark = "organism"|"predator"|"food"|"poison"|"trail";

export class Legend {
  readonly element = h("div", {class: "legend"});
  readonly #organism = h("span", {});
  readonly #predator = h("span", {class: "legend-item"}, mark("predator"), legend_texts.predator);
  readonly #trail = h("span", {class: "legend-item"}, mark("trail"), legend_texts.trail);

  constructor() {
    this.element.append(
      h("span", {class: "legend-item"}, mark("organism"), this.#organism), this.#predator,
      h("span", {class: "legend-item"}, mark("food"), legend_texts.food),
      h("span", {class: "legend-item"}, mark("poison"), legend_texts.poison), this.#trail);
  }

  refresh(world: ViewedWorld): void {
    this.element.hidden = !world.has_bodies;
    set_attribute(this.element, "data-skin", world.look.skin);
    set_attribute(this.element, "data-background", world.look.background);
    set_text(this.#organism, legend_texts[world.look.skin](world.feed.drawing?.health_max ?? 100));
    this.#predator.hidden = world.feed.drawing?.predators !== true;
    this.#trail.hidden = !world.look.trails;
  }
}

/** The three marks in both skins; app.css shows those of the look. */
function mark(kind: Mark): SVGElement {
  const drawing =
    svg("svg", {class: `mark mark-${kind}`, viewBox: "-8 -8 16 16", width: 16, height: 16, "aria-hidden": "true"});
  if (kind === "organism") {
    drawing.append(
      svg("circle", {class: "vivid mark-ring", r: 6.5}), svg("circle", {class: "vivid mark-body", r: 4.6}),
      svg("path", {class: "vivid mark-arc", d: "M0 -6.5A6.5 6.5 0 1 1 -6.5 0"}),
      svg("circle", {class: "classic mark-circle", r: 6.5}), svg("text", {class: "classic mark-number", y: 2.8}, "9"));
  } else if (kind === "predator") {
    drawing.append(svg("path", {class: "mark-predator", d: "M0 -7L6.1 3.5H-6.1Z"}));
  } else if (kind === "food") {
    drawing.append(
      svg("path", {class: "vivid mark-fill", d: "M-5.5 5.5C-7 -3 -2 -6.5 6 -6C6.5 2 3 6.5 -5.5 5.5Z"}),
      svg("circle", {class: "classic mark-fill", r: 4}));
  } else if (kind === "trail") {
    drawing.append(
      svg("path", {class: "mark-trail", d: "M-7 5Q-3 5 0 1"}),
      svg("path", {class: "mark-trail new", d: "M0 1Q3 -3 7 -4"}));
  } else {
    drawing.append(
      svg("path", {class: "vivid mark-fill", d: "M-6 -6L0 -2.2L6 -6L2.2 0L6 6L0 2.2L-6 6L-2.2 0Z"}),
      svg("circle", {class: "classic mark-fill", r: 4}));
  }
  return drawing;
}
