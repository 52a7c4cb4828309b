// View panel: selects what the island shows, and how. The same switches in the same order as in evoview
// (client/viewer/panels/view_panel.cpp).
import type {Look} from "../core/messages";
import {set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {default_look} from "../render/look";
import type {Panel, PanelContext} from "../world/panel_context";

type Which = Look["perception"];
type Switch = "trails"|"flashes"|"density"|"minimap"|"interpolate";

const which_names: ReadonlyArray<{value: Which; text: string}> = [
  {value: "none", text: "none"},
  {value: "selected", text: "at the mouse or selected"},
  {value: "all", text: "all"},
];

function names(...values: string[]): {value: string; text: string}[] {
  return values.map((value) => ({value, text: value}));
}

export class ViewPanel implements Panel {
  readonly name = "view";
  readonly title = "View";
  readonly element: HTMLElement;
  readonly #skin = this.#select(
    (skin) => this.#set(default_look(skin as Look["skin"], this.#look.background, this.#look.interpolate)));
  readonly #background = this.#select((background) => this.#set({background: background as Look["background"]}));
  readonly #colour_by = this.#select((colour_by) => this.#set({colour_by}));
  readonly #palette = this.#select((palette) => this.#set({palette: palette as Look["palette"]}));
  readonly #perception = this.#select((which) => this.#set({perception: which as Which}));
  readonly #forces = this.#select((which) => this.#set({forces: which as Which}));
  readonly #background_label = h("label", {}, "background");
  readonly #checks: {readonly[name in Switch]: HTMLInputElement} = {
    trails: this.#check("trails"),
    flashes: this.#check("flashes"),
    density: this.#check("density"),
    minimap: this.#check("minimap"),
    interpolate: this.#check("interpolate"),
  };
  readonly #follow: HTMLInputElement =
    h("input", {type: "checkbox", onchange: () => this.#context.world().selection.set_follow(this.#follow.checked)});
  readonly #follow_row = h("label", {class: "check"}, this.#follow, "keep the selected organism centred (L)");
  readonly #follow_hint = h("p", {class: "hint"}, "Click an organism to select it.");
  readonly #lineage_hint = h(
    "p", {class: "hint"},
    "Lineages are counted from the first generation. evoview counts them from a later one after one lineage has taken over.");

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    const {trails, flashes, density, minimap, interpolate} = this.#checks;
    const row = (input: HTMLElement, label: string) => h("label", {class: "check"}, input, label);
    this.element =
      h("div", {class: "panel panel-view"},
        h("div", {class: "view-fields"}, ...this.#field(this.#skin, "skin"),
          ...this.#field(this.#background, "background", this.#background_label),
          ...this.#field(this.#colour_by, "colour by (C)"), ...this.#field(this.#palette, "palette")),
        this.#lineage_hint, h("hr", {}),
        h("div", {class: "view-checks"}, row(trails, "trails of the last 3 simulated seconds (T)"),
          row(flashes, "flashes of meals and deaths")),
        h("hr", {}),
        h("div", {class: "view-fields"}, ...this.#field(this.#perception, "perception radii (V)"),
          ...this.#field(this.#forces, "forces (G)")),
        h("hr", {}),
        h("div", {class: "view-checks"}, row(density, "density map where organisms are too many"),
          row(minimap, "minimap while zoomed in"), row(interpolate, "smooth movement between snapshots")),
        h("hr", {}), this.#follow_row, this.#follow_hint);
  }

  refresh(): void {
    const world = this.#context.world();
    const {look} = world;
    set_options(this.#skin, names("vivid", "classic"), look.skin);
    set_options(this.#background, names("dark", "light"), look.background);
    this.#background.hidden = this.#background_label.hidden = look.skin === "classic"; // which is always grey
    set_options(
      this.#colour_by,
      [
        {value: "", text: look.skin === "vivid" ? "nothing (shade: health)" : "nothing"},
        {value: "health", text: "health"},
        {value: "lineage", text: "lineage (common ancestor)"},
        ...world.gene_names.map((gene) => ({value: gene, text: `gene ${gene}`})),
      ],
      look.colour_by);
    set_options(this.#palette, names("violet", "viridis", "cividis"), look.palette);
    set_options(this.#perception, [...which_names], look.perception);
    set_options(this.#forces, [...which_names], look.forces);
    for (const name of Object.keys(this.#checks) as Switch[]) {
      this.#checks[name].checked = look[name];
    }
    this.#lineage_hint.hidden = look.colour_by !== "lineage";
    this.#follow_row.hidden = world.selection.id === null;
    this.#follow_hint.hidden = world.selection.id !== null;
    this.#follow.checked = world.selection.follow;
  }

  get #look(): Look {
    return this.#context.world().look;
  }

  #set(change: Partial<Look>): void {
    this.#context.world().set_look(change);
    this.refresh();
  }

  #select(act: (value: string) => void): HTMLSelectElement {
    const select: HTMLSelectElement = h("select", {class: "field", onchange: () => act(select.value)});
    return select;
  }

  #check(name: Switch): HTMLInputElement {
    const input: HTMLInputElement = h("input", {type: "checkbox", onchange: () => this.#set({[name]: input.checked})});
    return input;
  }

  #field(control: HTMLElement, text: string, label = h("label", {})): [HTMLElement, HTMLElement] {
    control.id = `view-${text.replace(/[^a-z]+/g, "-")}`;
    label.htmlFor = control.id;
    set_text(label, text);
    return [control, label];
  }
}
