// View panel: selects what the island shows, and how. The same switches in the same order as in evoview
// (client/viewer/panels/view_panel.cpp).
import type {Look} from "../core/messages";
import {panels_texts} from "../texts/panels";
import {view_texts as texts} from "../texts/view";
import {set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {check, hint} from "../widgets/form";
import {default_look} from "../render/look";
import type {Panel, PanelContext} from "../world/panel_context";
import {of_browser} from "../world/storage";

type Which = Look["perception"];
type Switch = "trails"|"flashes"|"density"|"minimap"|"interpolate";

type Names = {
  readonly [value: string]: string
};

function options(names: Names): {value: string; text: string}[] {
  return Object.entries(names).map(([value, text]) => ({value, text}));
}

export class ViewPanel implements Panel {
  readonly name = "view";
  readonly title = panels_texts.view;
  readonly element: HTMLElement;
  readonly #skin = this.#select(
    (skin) => this.#set(default_look(skin as Look["skin"], this.#look.background, this.#look.interpolate)));
  readonly #background = this.#select((background) => this.#set({background: background as Look["background"]}));
  readonly #colour_by = this.#select((colour_by) => this.#set({colour_by}));
  readonly #palette = this.#select((palette) => this.#set({palette: palette as Look["palette"]}));
  readonly #perception = this.#select((which) => this.#set({perception: which as Which}));
  readonly #forces = this.#select((which) => this.#set({forces: which as Which}));
  readonly #background_label = h("label", {});
  readonly #language = this.#select((language) => {
    of_browser.set("language", language);
    this.#context.reload();
  });
  readonly #checks: {readonly[name in Switch]: HTMLInputElement} = {
    trails: this.#check("trails"),
    flashes: this.#check("flashes"),
    density: this.#check("density"),
    minimap: this.#check("minimap"),
    interpolate: this.#check("interpolate"),
  };
  readonly #follow: HTMLInputElement =
    h("input", {type: "checkbox", onchange: () => this.#context.world().selection.set_follow(this.#follow.checked)});
  readonly #follow_row = check(this.#follow, texts.follow);
  readonly #follow_hint = hint(texts.select_first);
  readonly #lineage_hint = hint(texts.lineages);

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    const row = (name: Switch) => check(this.#checks[name], texts.switches[name]);
    this.element =
      h("div", {class: "panel panel-view"},
        h("div", {class: "view-fields"}, ...this.#field("skin", this.#skin, texts.skin),
          ...this.#field("background", this.#background, texts.background, this.#background_label),
          ...this.#field("colour", this.#colour_by, texts.colour_by),
          ...this.#field("palette", this.#palette, texts.palette)),
        this.#lineage_hint, h("hr", {}), h("div", {class: "view-checks"}, row("trails"), row("flashes")), h("hr", {}),
        h("div", {class: "view-fields"}, ...this.#field("perception", this.#perception, texts.perception),
          ...this.#field("forces", this.#forces, texts.forces)),
        h("hr", {}), h("div", {class: "view-checks"}, row("density"), row("minimap"), row("interpolate")), h("hr", {}),
        this.#follow_row, this.#follow_hint, h("hr", {}),
        h("div", {class: "view-fields"}, ...this.#field("language", this.#language, texts.language)));
  }

  refresh(): void {
    const world = this.#context.world();
    const {look} = world;
    set_options(this.#skin, options(texts.skins), look.skin);
    set_options(this.#background, options(texts.backgrounds), look.background);
    this.#background.hidden = this.#background_label.hidden = look.skin === "classic"; // which is always grey
    set_options(
      this.#colour_by,
      [
        {value: "", text: look.skin === "vivid" ? texts.by_nothing_vivid : texts.by_nothing},
        {value: "health", text: texts.by_health},
        {value: "lineage", text: texts.by_lineage},
        ...world.gene_names.map((gene) => ({value: gene, text: texts.by_gene(gene)})),
      ],
      look.colour_by);
    set_options(this.#palette, options(texts.palettes), look.palette);
    set_options(this.#perception, options(texts.of_which), look.perception);
    set_options(this.#forces, options(texts.of_which), look.forces);
    for (const name of Object.keys(this.#checks) as Switch[]) {
      this.#checks[name].checked = look[name];
    }
    set_options(this.#language, options(texts.languages), of_browser.get("language"));
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

  #field(name: string, control: HTMLElement, text: string, label = h("label", {})): [HTMLElement, HTMLElement] {
    control.id = `view-${name}`;
    label.htmlFor = control.id;
    set_text(label, text);
    return [control, label];
  }
}
