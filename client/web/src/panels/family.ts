// Family tree panel: the selected organism and its ancestors, one row per generation, the earliest at the top. A click
// on an ancestor shows the beginning of its generation in a replay and selects it there.
//
// Keyboard  The drawing is one tab stop. Arrow keys move between relatives; Enter shows the moment.
import {type Ancestor, LineageReader, name_key, type OrganismName} from "../family/lineage";
import {ancestor_text, type FamilyTree, family_tree, neighbour} from "../family/tree";
import {h, set_text, svg} from "../widgets/dom";
import {with_separators} from "../texts/numbers";
import type {ViewedWorld} from "../world/world";
import type {Panel, PanelContext} from "../world/panel_context";
import {Width} from "./width";

const generation_choices = [5, 10, 20, 50, 100];
const row_height = 36;
const reach_px = 24; // a pointer this near to an organism points at it

export class FamilyPanel implements Panel {
  readonly name = "family";
  readonly title = "Family tree";
  readonly element: HTMLElement;

  #root: OrganismName|null = null;
  #run_id = ""; // of `root`
  #wanted = ""; // what was requested last
  #number = 0; // of the last request
  #ancestors: ReadonlyMap<string, Ancestor> = new Map();
  #tree: FamilyTree|null = null;
  #problem = "";
  #drawn = "";
  #at = {row: 0, place: 0}; // the organism that Tab leads to
  #spots: SVGGElement[][] = [];
  #positions: {x: number; y: number}[][] = [];

  // ---- elements ----
  readonly #heading = h("h2", {});
  readonly #generations: HTMLSelectElement = h(
    "select", {class: "field", onchange: () => this.refresh()},
    ...generation_choices.map((count) => h("option", {value: count, selected: count === 10}, `${count} generations`)));
  readonly #both: HTMLInputElement = h("input", {type: "checkbox", checked: true, onchange: () => this.refresh()});
  readonly #reroot = h("button", {class: "button", onclick: () => this.#take_selection()});
  readonly #status = h("p", {role: "status"});
  readonly #retry = h("button", {class: "button", onclick: () => this.#try_again()}, "Retry");
  readonly #drawing = h("div", {class: "family-drawing"});
  readonly #note = h("p", {class: "family-note", "aria-live": "polite"});
  readonly #help =
    h("div", {},
      h("p", {class: "hint"},
        "Thick lines lead to first parents, which gave at least half of the genes; dashed lines lead to second " +
          "parents. Filled: children; hollow: copies (survivors, elite); " +
          "diamond: the first parent lived on another island."),
      h("p", {class: "hint"},
        "Click an organism to see the beginning of its generation. With the keyboard: arrow keys, Enter."));

  readonly #width: Width;

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    this.element =
      h("div", {class: "panel family"}, this.#heading,
        h("div", {class: "row"}, this.#generations, h("label", {class: "check"}, this.#both, "both parents"),
          this.#reroot),
        this.#status, this.#retry, this.#drawing, this.#note, this.#help);
    this.#generations.setAttribute("aria-label", "Generations");
    this.#width = new Width(this.element, () => this.refresh());
  }

  /** subject  {generation, island, organism}: shows the tree of this organism. */
  show(subject: {[key: string]: unknown}): void {
    const {generation, island, organism} = subject;
    if (typeof generation === "number" && typeof island === "number" && typeof organism === "number") {
      this.#set_root({generation, island, organism});
    }
    this.refresh();
  }

  refresh(): void {
    const world = this.#context.world();
    const snapshot = world.snapshot;
    if (snapshot && this.#root && this.#run_id !== snapshot.run_id) {
      this.#set_root(null);
    }
    if (!this.#root && snapshot && world.selection.id !== null) {
      this.#set_root(selection_of(world));
    }
    this.#request(world);
    this.#draw(world);
  }

  #set_root(root: OrganismName|null): void {
    this.#root = root;
    this.#run_id = this.#context.world().snapshot?.run_id ?? "";
    this.#tree = null;
    this.#problem = "";
  }

  #take_selection(): void {
    this.#set_root(selection_of(this.#context.world()));
    this.refresh();
  }

  #try_again(): void {
    this.#wanted = "";
    this.refresh();
  }

  // ---- the lineage ----

  #request(world: ViewedWorld): void {
    const root = this.#root;
    if (!root) {
      return;
    }
    const generations = Number(this.#generations.value);
    const wanted = `${this.#run_id}/${name_key(root)}/${generations}`;
    if (wanted === this.#wanted) {
      return;
    }
    this.#wanted = wanted;
    this.#problem = "";
    const number = ++this.#number;
    this.#read(world, root, Math.max(1, root.generation - generations + 1))
      .then(
        (ancestors) => {
          if (number === this.#number) {
            this.#ancestors = ancestors;
            this.#drawn = "";
            this.refresh();
          }
        },
        (error: Error) => {
          if (number === this.#number) {
            this.#problem = error.message;
            this.refresh();
          }
        });
  }

  async #read(world: ViewedWorld, of: OrganismName, first_generation: number): Promise<ReadonlyMap<string, Ancestor>> {
    const reader = new LineageReader();
    let part = await world.server.request("export_run", {
      world: world.shown,
      table: "RUN_TABLE_LINEAGE",
      format: "TEXT_FORMAT_JSON_LINES",
      of: {...of},
      first_generation,
    });
    reader.add(part.text, part.last === true);
    while (!part.last) {
      part = await world.server.request("continue_export", {export_id: part.export_id});
      reader.add(part.text, part.last === true);
    }
    return reader.ancestors;
  }

  // ---- the drawing ----

  #draw(world: ViewedWorld): void {
    const root = this.#root;
    set_text(
      this.#heading,
      root ? `Ancestors of organism ${root.organism} of generation ${with_separators(root.generation)}` :
             "Family tree");
    const selected = world.selection.id !== null && world.snapshot ? selection_of(world) : null;
    this.#reroot.hidden = !selected || !root || name_key(selected) === name_key(root);
    set_text(this.#reroot, selected ? `Tree of organism ${selected.organism}` : "");
    const width = this.#width.within(280, 1000);
    const drawn = root ?
      [this.#run_id, name_key(root), this.#generations.value, this.#both.checked, this.#ancestors.size, width].join(
        "/") :
      "";
    if (drawn !== this.#drawn) {
      this.#drawn = drawn;
      this.#tree =
        root ? family_tree(this.#ancestors, root, this.#both.checked, Number(this.#generations.value)) : null;
      this.#build(width);
    }
    set_text(
      this.#status,
      !root           ? "Select an organism to see its ancestors." :
        this.#problem ? `The ancestors are unknown: ${this.#problem}.` :
        this.#tree ? "" :
                     "Loading …");
    this.#status.classList.toggle("error", this.#problem !== "");
    this.#retry.hidden = this.#problem === "";
    this.#help.hidden = this.#drawing.hidden = this.#note.hidden = !this.#tree;
    const generation = world.snapshot?.generation ?? 0;
    this.#drawing.querySelectorAll(".family-generation")
      .forEach(
        (label) => label.classList.toggle("shown", label.getAttribute("data-generation") === String(generation)));
    this.#mark(selected ? name_key(selected) : "");
  }

  #build(width: number): void {
    const tree = this.#tree;
    this.#spots = [];
    this.#positions = [];
    if (!tree) {
      this.#drawing.replaceChildren();
      return;
    }
    const left = 46, room = width - left - 8, each = room / tree.width;
    const radius = Math.min(11, Math.max(2.5, each * 0.42)), named = radius >= 9;
    const height = tree.rows.length * row_height + 8;
    const root = svg("svg", {
      class: "family-svg",
      viewBox: `0 0 ${width} ${height}`,
      width,
      height,
      role: "group",
      "aria-label": `Family tree of ${tree.rows.length} generations`,
      onkeydown: (event: KeyboardEvent) => this.#press(event),
      onclick: (event: MouseEvent) => this.#click(event),
      onpointermove: (event: PointerEvent) => this.#point(event),
    });
    this.#positions =
      tree.rows.map((row, i) => row.map((spot) => ({x: left + spot.x * each, y: i * row_height + row_height / 2 + 4})));
    const lines = svg("g", {});
    tree.rows.forEach((row, i) => row.forEach((spot, place) => {
      const to = this.#positions[i]![place]!;
      for (const [parent, kind] of [[spot.second, "second"], [spot.first, "first"]] as const) {
        const from = parent >= 0 ? this.#positions[i - 1]![parent]! : null;
        if (from && !(kind === "second" && spot.second === spot.first)) {
          lines.append(svg("path", {
            class: `family-line ${kind}`,
            d: `M${from.x.toFixed(1)} ${from.y}C${from.x.toFixed(1)} ${from.y + row_height / 2} ${to.x.toFixed(1)} ` +
              `${to.y - row_height / 2} ${to.x.toFixed(1)} ${to.y}`
          }));
        }
      }
    }));
    root.append(lines);
    this.#at = {row: tree.rows.length - 1, place: 0};
    this.#spots = tree.rows.map((row, i) => {
      const generation = tree.first_generation + i;
      root.append(svg(
        "text", {class: "family-generation", "data-generation": generation, x: 2, y: this.#positions[i]![0]!.y},
        with_separators(generation)));
      return row.map((spot, place) => {
        const {x, y} = this.#positions[i]![place]!;
        const {ancestor} = spot;
        const copy = ancestor.origin === "survivor" || ancestor.origin === "elite";
        const migrated = ancestor.parents[0] !== undefined && ancestor.parents[0].island !== ancestor.island;
        const group = svg(
          "g", {
            class: `family-spot${copy ? " copy" : ""}`,
            role: "button",
            tabindex: i === this.#at.row && place === this.#at.place ? 0 : -1,
            "aria-label": ancestor_text(ancestor),
            "data-name": name_key(ancestor),
            onfocus: () => this.#take_focus({row: i, place}),
          },
          migrated ? svg("polygon", {
            points: `${x},${y - radius - 1} ${x + radius + 1},${y} ${x},${y + radius + 1} ${x - radius - 1},${y}`
          }) :
                     svg("circle", {cx: x, cy: y, r: radius}),
          named && svg("text", {x, y}, String(ancestor.organism)));
        root.append(group);
        return group;
      });
    });
    this.#drawing.replaceChildren(root);
    this.#describe(this.#at.row, this.#at.place);
  }

  /** Marks the selected organism. */
  #mark(selected: string): void {
    for (const group of this.#spots.flat()) {
      group.classList.toggle("selected", group.getAttribute("data-name") === selected);
    }
  }

  #describe(row: number, place: number): void {
    const ancestor = this.#tree?.rows[row]?.[place]?.ancestor;
    set_text(this.#note, ancestor ? ancestor_text(ancestor) : "");
  }

  /** The organism nearest to the pointer, so that a finger hits small ones, too. */
  #nearest(event: MouseEvent): {row: number; place: number}|null {
    const box = (event.currentTarget as Element).getBoundingClientRect();
    const x = event.clientX - box.left, y = event.clientY - box.top;
    let found: {row: number; place: number}|null = null, least = reach_px;
    this.#positions.forEach((row, i) => row.forEach((position, place) => {
      const distance = Math.hypot(position.x - x, position.y - y);
      if (distance < least) {
        found = {row: i, place};
        least = distance;
      }
    }));
    return found;
  }

  #point(event: PointerEvent): void {
    const spot = this.#nearest(event);
    (event.currentTarget as Element).classList.toggle("pointing", spot !== null);
    if (spot) {
      this.#describe(spot.row, spot.place);
    }
  }

  #click(event: MouseEvent): void {
    const spot = this.#nearest(event);
    if (spot) {
      this.#spots[spot.row]![spot.place]!.focus();
      this.#go_to(spot.row, spot.place);
    }
  }

  #take_focus(spot: {row: number; place: number}): void {
    this.#spots[this.#at.row]?.[this.#at.place]?.setAttribute("tabindex", "-1");
    this.#at = spot;
    this.#spots[spot.row]![spot.place]!.setAttribute("tabindex", "0");
    this.#describe(spot.row, spot.place);
  }

  #press(event: KeyboardEvent): void {
    if (event.key.startsWith("Arrow") && this.#tree) {
      const next = neighbour(this.#tree, this.#at.row, this.#at.place, event.key);
      this.#spots[next.row]![next.place]!.focus();
    } else if (event.key === "Enter" || event.key === " ") {
      this.#go_to(this.#at.row, this.#at.place);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  #go_to(row: number, place: number): void {
    const ancestor = this.#tree!.rows[row]![place]!.ancestor;
    void this.#context.attempt(async () => {
      const world = this.#context.world();
      await world.past.show(ancestor.generation);
      if (world.island !== ancestor.island) {
        world.choose_island(ancestor.island);
      }
      world.selection.select(ancestor.organism);
    });
  }
}

function selection_of(world: ViewedWorld): OrganismName {
  return {generation: world.snapshot!.generation, island: world.island, organism: world.selection.id!};
}
