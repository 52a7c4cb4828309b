// ClassWall: the page of a teacher: the worlds of a class as live tiles, and what the teacher does with them.
//
// It covers the page of the worlds. F freezes, Enter opens a world, Escape returns to the page.
import type {Look} from "../core/messages";
import {app_texts} from "../texts/app";
import {code_texts, wall_texts as texts} from "../texts/class";
import {set_attribute, set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {save_file} from "../widgets/files";
import {button} from "../widgets/form";
import {Notices, type Notify} from "../widgets/notices";
import type {Server} from "../world/server";

import {ClassModel} from "./class_model";
import {CodeScreen} from "./code_screen";
import {collect} from "./collecting";
import {start_of} from "./compare";
import {CompareView} from "./compare_view";
import {ForAll, type ForAllContext} from "./for_all";
import {Members} from "./members";
import type {Order} from "./standing";
import {class_style} from "./style";
import {WallTiles} from "./tiles";

type View = "worlds"|"compare"|"members";

export interface WallContext {
  readonly server: Server;
  look(): Look;
  /** Shows the world of a student. */
  open_world(world: string, student: string): void;
  /** Called after the wall has closed. */
  closed(): void;
}

export class ClassWall implements ForAllContext {
  readonly element: HTMLElement;
  readonly model: ClassModel;
  readonly server: Server;
  readonly #context: WallContext;
  readonly #notices = new Notices();
  readonly #live = h("p", {class: "visually-hidden", role: "status", "aria-live": "polite"});
  readonly #count = h("span", {class: "wall-count"});
  readonly #guessed = h("p", {class: "warning wall-guessed", role: "status"});
  readonly #frozen = h("span", {class: "badge wall-frozen", hidden: true}, texts.frozen_badge);
  readonly #order: HTMLSelectElement = h(
    "select", {class: "field", "aria-label": texts.order, onchange: () => this.#set_order(this.#order.value as Order)});
  readonly #views: {[view in View]: HTMLButtonElement};
  readonly #for_all: ForAll;
  readonly #tiles: WallTiles;
  readonly #members: Members;
  readonly #compare: CompareView;
  readonly #code: CodeScreen;
  readonly #collect: HTMLButtonElement;
  readonly #empty = h("p", {class: "wall-empty", hidden: true});
  readonly #ends: (() => void)[];
  #view: View = "worlds";
  #was_frozen: boolean|null = null;
  #joined: ReadonlySet<string>|null = null; // names of the members who have joined
  #is_collecting = false;

  constructor(readonly name: string, context: WallContext) {
    this.#context = context;
    const server = this.server = context.server;
    this.model = new ClassModel(server, name);
    const open = (world: string): void => this.#open(world);
    this.#for_all = new ForAll(this);
    this.#tiles = new WallTiles(server, () => context.look(), open);
    this.#members = new Members(this);
    this.#compare = new CompareView(this, open);
    this.#code = new CodeScreen(this);
    const view = (name: View, text: string): HTMLButtonElement => button(text, () => this.#show(name));
    this.#views = {
      worlds: view("worlds", texts.worlds),
      compare: view("compare", texts.compare),
      members: view("members", texts.members)
    };
    this.#collect = button(texts.collect, () => void this.#do_collect());
    const code = button(texts.code, () => this.#code.open(), {class: "button button-primary"});
    const back =
      button(texts.back, () => this.close(), {class: "button button-quiet wall-back", title: texts.back_help});
    const sort = h("label", {class: "row wall-order"}, h("span", {}, texts.order), this.#order);
    this.element =
      h("main", {class: "class-wall", "aria-label": texts.name(name)},
        h("header", {class: "wall-bar"}, back, h("h1", {}, name), this.#count, this.#frozen, h("span", {class: "grow"}),
          this.#for_all.freeze, code),
        h("nav", {class: "wall-nav", "aria-label": texts.views}, ...Object.values(this.#views), this.#collect,
          h("span", {class: "grow"}), sort),
        this.#guessed,
        h("div", {class: "wall-body"}, this.#for_all.element, this.#tiles.element, this.#empty, this.#members.element,
          this.#compare.element),
        this.#live, this.#notices.element);
    set_options(
      this.#order, (["name", "fitness", "help"] as const).map((value) => ({value, text: texts.orders[value]})), "name");
    const key = (event: KeyboardEvent): void => this.#key(event);
    document.addEventListener("keydown", key);
    this.#ends = [() => document.removeEventListener("keydown", key), this.model.changes.listen(() => this.refresh())];
    server.access.set_taking_part(true);
    this.#show("worlds");
  }

  /** Shows the wall over the page. */
  async open(): Promise<void> {
    await class_style();
    document.body.append(this.element);
    this.refresh();
    this.#tiles.focus();
  }

  /** Focuses the tile of a world from which the teacher returns. */
  focus(world: string): void {
    this.#tiles.focus(world);
  }

  close(): void {
    this.#ends.forEach((end) => end());
    this.#tiles.close();
    this.#compare.close();
    this.#code.close();
    this.model.close();
    this.element.remove();
    this.#context.closed();
  }

  refresh(): void {
    const {model, server} = this, {students, info} = model;
    if (server.state.phase === "refused") {
      this.close();
      return;
    }
    const connected = students.filter(({member}) => (member.sessions ?? 0) > 0).length;
    const {phase, message} = server.state;
    set_text(
      this.#count,
      phase !== "open" ? app_texts.lost(message) :
        info === null  ? "" :
                         texts.connected(connected, students.length));
    set_text(this.#guessed, info?.codes_are_guessed ? code_texts.guessed : "");
    this.#frozen.hidden = !model.is_frozen;
    set_attribute(this.element, "data-frozen", model.is_frozen ? "" : null);
    this.#for_all.refresh();
    const is_empty = students.length === 0;
    this.#empty.hidden = this.#view !== "worlds" || !is_empty;
    set_text(
      this.#empty,
      model.problem   ? model.problem :
        info === null ? texts.no_class(this.name) :
        is_empty      ? texts.no_student :
                        "");
    if (this.#view === "worlds") {
      this.#tiles.refresh(students, model.is_frozen);
    } else {
      (this.#view === "members" ? this.#members : this.#compare).refresh();
    }
    this.#announce();
    this.#notices.refresh();
  }

  // ---- ForAllContext ----

  notify: Notify = (text, holds, action, stays) => this.#notices.show(text, holds, action, stays);

  attempt = async(what: () => Promise<unknown>): Promise<boolean> => {
    this.#notices.forget_refusal();
    try {
      await what();
      return true;
    } catch (error) {
      this.notify(error instanceof Error ? error.message : String(error), undefined, undefined, true);
      return false;
    }
  };

  // ---- private ----

  #show(view: View): void {
    this.#view = view;
    for (const [name, tab] of Object.entries(this.#views)) {
      set_attribute(tab, "aria-pressed", String(name === view));
    }
    this.#for_all.element.hidden = this.#tiles.element.hidden = view !== "worlds";
    this.#order.parentElement!.hidden = view !== "worlds";
    this.#members.element.hidden = view !== "members";
    this.#compare.element.hidden = view !== "compare";
    this.refresh();
  }

  #set_order(order: Order): void {
    this.#tiles.order = order;
    this.refresh();
  }

  #open(world: string): void {
    const student = this.model.students.find((one) => one.world === world);
    if (student?.info) {
      this.close();
      this.#context.open_world(world, student.name);
    } else {
      this.notify(texts.no_world_of(student?.name ?? world));
    }
  }

  #key(event: KeyboardEvent): void {
    const is_typing =
      event.target instanceof Element && event.target.closest("input, textarea, select, dialog") !== null;
    if (event.defaultPrevented || is_typing || event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    if (event.key === "Escape") {
      event.preventDefault();
      this.close();
    } else if (event.key.toLowerCase() === "f") {
      event.preventDefault();
      void this.#for_all.toggle_freeze();
    }
  }

  /** Announces freezing, and members who have joined, to screen readers. */
  #announce(): void {
    const {model} = this, joined = new Set(model.members.filter((one) => one.joined).map(({name = ""}) => name));
    const said: string[] = [];
    if (model.info === null) {
      return;
    }
    if (this.#was_frozen !== null && this.#was_frozen !== model.is_frozen) {
      said.push(model.is_frozen ? texts.said_frozen : texts.said_goes_on);
    }
    if (this.#joined !== null) {
      said.push(...[...joined].filter((name) => !this.#joined!.has(name)).map(texts.said_joined));
    }
    this.#was_frozen = model.is_frozen;
    this.#joined = joined;
    if (said.length > 0) {
      set_text(this.#live, said.join(" "));
    }
  }

  async #do_collect(): Promise<void> {
    if (this.#is_collecting) {
      return;
    }
    this.#is_collecting = true;
    const {students, info} = this.model, start = start_of(info?.template ?? {}, this.server.parameters);
    await this.attempt(async () => {
      const {archive, problems} = await collect(this.server, this.name, students, start, (done) => {
        set_text(this.#collect, texts.collecting(done, students.length));
      });
      save_file(archive, `${this.name}.tar`);
      this.notify(
        problems.length === 0 ? texts.collected(students.length) : texts.incomplete(problems), undefined, undefined,
        problems.length > 0);
    });
    this.#is_collecting = false;
    set_text(this.#collect, texts.collect);
  }
}
