// Family tree panel: one organism or a whole generation, and its ancestors, one row per generation, the earliest at the
// top. Names the common ancestors of the generation, and of two organisms that the user marks. A click on an organism
// shows the beginning of its generation in a replay and selects it there.
import {FamilyData, type Subject} from "../family/family_data";
import type {OrganismName} from "../family/lineage";
import {ShownTree} from "../family/shown_tree";
import type {FamilyTree, Place} from "../family/spot";
import {place_of} from "../family/tree";
import {gene_choices} from "../world/gene_axes";
import {origin_run_of} from "../world/origin";
import {family_texts} from "../texts/family";
import {h, set_text} from "../widgets/dom";
import {hint, row, symbol_button} from "../widgets/form";
import type {Panel, PanelContext} from "../world/panel_context";
import type {ViewedWorld} from "../world/world";
import {FamilyChoices} from "./family_choices";
import {FamilyDrawing} from "./family_drawing";
import {legend_parts} from "./family_legend";
import {FamilyMarks, organism_at} from "./family_marks";
import {FamilyNote} from "./family_note";
import {FamilyStatus} from "./family_status";
import {FamilyTable} from "./family_table";
import {OriginNote} from "./origin_note";
import {Width} from "./width";

const zoom_of_button = 1.5;

export class FamilyPanel implements Panel {
  readonly name = "family";
  readonly title = family_texts.title;
  readonly element: HTMLElement;

  #subject: Subject|null = null;
  readonly #data = new FamilyData(() => this.refresh());
  readonly #shown = new ShownTree();
  readonly #choices = new FamilyChoices(() => this.refresh());
  readonly #status = new FamilyStatus(this.#choices, this.#data, () => this.refresh());
  readonly #marks = new FamilyMarks(() => this.refresh());
  readonly #note = new FamilyNote((at) => this.#mark(at));
  readonly #table = new FamilyTable();
  readonly #drawing = new FamilyDrawing({
    read: (at) => this.#note.read(this.#context.world(), at),
    go_to: (at) => this.#go_to(at),
    mark: (at) => this.#mark(at),
  });
  readonly #origin: OriginNote;
  #origin_run = ""; // of which the world is a fork, if the tree ends at the fork
  #origin_asked = "";
  readonly #reroot = h("button", {class: "button", onclick: () => this.#take_shown()});
  readonly #legend = h("p", {class: "hint family-legend", role: "group", "aria-label": family_texts.legend});
  readonly #tree_parts: HTMLElement;
  readonly #width: Width;
  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    this.#origin = new OriginNote(context, () => undefined);
    this.#tree_parts =
      h("div", {class: "panel"}, this.#status.loaded, this.#origin.element, this.#status.sentence,
        row(
          symbol_button("−", family_texts.zoom_out, () => this.#drawing.zoom(1 / zoom_of_button)),
          symbol_button("+", family_texts.zoom_in, () => this.#drawing.zoom(zoom_of_button)),
          symbol_button(family_texts.fit, family_texts.fit_title, () => this.#drawing.fit())),
        this.#drawing.element, this.#legend, this.#note.element, this.#marks.element, this.#table.element,
        hint(family_texts.help_lines), hint(family_texts.help_keys));
    this.element =
      h("div", {class: "panel family"}, this.#status.heading, this.#choices.element, this.#reroot, this.#status.problem,
        this.#tree_parts);
    this.#width = new Width(this.element, () => this.refresh());
  }

  /** subject  {generation, island, organism}: shows the ancestors of this organism. */
  show(subject: {[key: string]: unknown}): void {
    const {generation, island, organism} = subject;
    if (typeof generation === "number" && typeof island === "number" && typeof organism === "number") {
      this.#choices.whole = false;
      this.#set_subject({generation, island, organism});
    }
    this.refresh();
  }

  refresh(): void {
    const world = this.#context.world(), run_id = world.snapshot?.run_id;
    if (run_id && this.#subject && (this.#subject.run_id !== run_id || this.#subject.whole !== this.#choices.whole)) {
      this.#subject = null;
    }
    const root = this.#shown_root(world);
    if (!this.#subject && root) {
      this.#set_subject(root);
    }
    this.#choices.set_genes(world.gene_names);
    this.#load(world);
    const subject = this.#subject, shown = this.#shown;
    shown.update(subject, this.#data, this.#choices.form);
    this.#status.show(subject, shown);
    this.#draw_reroot(root);
    this.#tree_parts.hidden = !shown.tree;
    if (shown.tree) {
      this.#draw(world, shown.tree);
      this.#show_origin(world, shown.tree);
    } else {
      this.#drawing.show(null, "");
      this.#table.show(null);
    }
  }

  // ---- the subject ----

  /** What the tree shows if it begins at the shown moment; null if that needs a selected organism. */
  #shown_root({snapshot, island, selection: {id: selected}}: ViewedWorld): OrganismName|null {
    return !snapshot      ? null :
      this.#choices.whole ? {generation: snapshot.generation, island, organism: 0} :
      selected === null   ? null :
                            {generation: snapshot.generation, island, organism: selected};
  }

  #set_subject(root: OrganismName): void {
    const run_id = this.#context.world().snapshot?.run_id ?? "";
    if (this.#subject?.run_id !== run_id) {
      this.#note.forget();
    }
    this.#subject = {run_id, whole: this.#choices.whole, root};
  }

  #take_shown(): void {
    const root = this.#shown_root(this.#context.world());
    if (root) {
      this.#set_subject(root);
    }
    this.refresh();
  }

  #load(world: ViewedWorld): void {
    const source = {server: world.server, world: world.shown, choices: gene_choices(world.info)};
    const subject = this.#subject, tree = this.#shown.tree;
    const organisms = (world.snapshot?.live?.organism_count ?? 0) * Math.max(1, world.info?.island_count ?? 1);
    if (subject) {
      this.#data.want(source, subject, this.#choices.form.generations, organisms);
    }
    if (tree && this.#data.lineage && this.#choices.colour_by.kind === "gene") {
      void this.#data.want_genes(
        source, tree.first_generation, tree.first_generation + tree.rows.length - 1,
        organisms * world.gene_names.length);
    }
  }

  // ---- the drawing ----

  #draw_reroot(root: OrganismName|null): void {
    const subject = this.#subject;
    this.#reroot.hidden = !subject || !root ||
      (subject.root.generation === root.generation && subject.root.island === root.island &&
       (subject.whole || subject.root.organism === root.organism));
    set_text(
      this.#reroot,
      !root                 ? "" :
        this.#choices.whole ? family_texts.tree_of_generation(root.generation) :
                              family_texts.tree_of_organism(root.organism));
  }

  #draw(world: ViewedWorld, tree: FamilyTree): void {
    const {of_all} = this.#shown, colour_by = this.#choices.colour_by, marks = this.#marks.show(tree);
    if (this.#shown.colour(colour_by, this.#data)) {
      this.#legend.replaceChildren(...legend_parts(this.#shown.colouring!.legend, tree.first_generation));
    }
    const colouring = this.#shown.colouring!, {snapshot, island, selection: {id: selected}} = world;
    this.#drawing.show(
      {
        tree,
        width: this.#width.within(1600),
        colours: colouring.colours,
        lines_in_colours: colour_by.kind === "lineage",
        of_all,
        of_two: marks.of_two,
        marked: marks.places,
        selected: snapshot && selected !== null ?
          place_of(tree, {generation: snapshot.generation, island, organism: selected}) :
          null,
        shown_generation: snapshot?.generation ?? 0,
      },
      family_texts.drawing(tree.rows.length, this.#shown.organism_count));
    this.#drawing.element.dataset.layoutMs = this.#shown.layout_ms.toFixed(1); // for measurements
    this.#note.show({tree, of_all, marks, colouring, colour_by, genes: this.#data.genes, gene_names: world.gene_names});
    this.#table.show({tree, of_all, of_two: marks.of_two});
  }

  /** Says where the earlier ancestors are if the tree ends because the world is a fork. */
  #show_origin({server, shown}: ViewedWorld, {first_generation, rows}: FamilyTree): void {
    const generation = first_generation - 1, {lineage} = this.#data, asked = `${this.#subject?.run_id} ${generation}`;
    const ends = lineage !== null && lineage.first_generation <= generation && lineage.generations_left_out === 0 &&
      rows[0]!.some(({ancestor: {origin}}) => origin !== "initial" && origin !== "placed");
    if (ends && asked !== this.#origin_asked) {
      this.#origin_asked = asked;
      this.#origin_run = "";
      server.request("get_breeding", {world: shown, generation}).catch((error: unknown) => {
        this.#origin_run = asked === this.#origin_asked ? origin_run_of(error) : this.#origin_run;
        this.refresh();
      });
    }
    this.#origin.update(ends ? this.#origin_run : "", generation);
  }

  // ---- one organism ----

  #mark(at: Place): void {
    if (this.#shown.tree) {
      this.#note.read(this.#context.world(), at);
      this.#marks.toggle(organism_at(this.#shown.tree, at));
    }
  }

  #go_to(at: Place): void {
    const world = this.#context.world(), tree = this.#shown.tree;
    if (!tree) {
      return;
    }
    this.#note.read(world, at);
    const {generation, island, organism} = organism_at(tree, at);
    void this.#context.attempt(async () => {
      await world.past.show(generation);
      if (world.island !== island) {
        world.choose_island(island);
      }
      world.selection.select(organism);
    });
  }
}
