// WorldsPanel: the worlds of the server with their state, the islands of the shown world, and the commands that create,
// fork and delete worlds.
import {common_texts} from "../texts/common";
import {with_separators} from "../texts/numbers";
import {panels_texts} from "../texts/panels";
import {speed_text, state_word} from "../texts/states";
import {worlds_texts as texts} from "../texts/worlds";
import {guarded_button, set_allowed} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {hint, Question} from "../widgets/form";
import {name_problem, unused_name} from "../world/names";

import type {Panel, PanelContext} from "../world/panel_context";

import {IslandsTable} from "./islands_table";
import {new_world_dialog} from "./new_world";
import {table_head, type TableRow, update_rows} from "./rows";

export class WorldsPanel implements Panel {
  readonly name = "worlds";
  readonly title = panels_texts.worlds;
  readonly element: HTMLElement;

  #worlds = h("tbody", {});
  #islands: IslandsTable;
  #create: HTMLButtonElement;
  #fork: HTMLButtonElement;
  #remove: HTMLButtonElement;
  #why = h("p", {class: "hint"});
  #confirm: Question;
  #question = h("p", {});
  #deleted = "";
  #fork_form: Question;
  #fork_name = h("input", {class: "field grow", "aria-label": texts.fork_name, maxlength: 64, spellcheck: "false"});
  #fork_from = h("p", {});
  #fork_error = h("p", {class: "error", role: "alert"});

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    const {notify} = context;
    this.#create = guarded_button(texts.create, notify, () => this.#open_dialog());
    this.#fork = guarded_button(texts.fork, notify, () => this.#ask_fork());
    this.#remove = guarded_button(texts.remove, notify, () => this.#ask_delete());
    this.#confirm = new Question(
      {before: [this.#question, hint(texts.file_stays)]}, texts.do_remove, () => void this.#do_delete(),
      () => this.#remove);
    this.#fork_form = new Question(
      {before: [this.#fork_from], field: this.#fork_name, after: [this.#fork_error]}, texts.do_fork,
      () => void this.#do_fork(), () => this.#fork);
    this.#islands = new IslandsTable(context, () => this.element.hidden || this.refresh());
    this.element =
      h("div", {class: "panel panel-worlds"},
        h("table", {class: "table", "aria-label": texts.table}, table_head(texts.headings, 2), this.#worlds),
        h("div", {class: "row"}, this.#create, this.#fork, this.#remove), this.#why, this.#confirm.element,
        this.#fork_form.element, this.#islands.element);
  }

  refresh(): void {
    const {server} = this.#context, world = this.#context.world();
    update_rows(this.#worlds, this.#world_rows(), 1);
    const why_create = server.access.why_not("create_world");
    set_allowed(this.#create, why_create, texts.create_help);
    set_allowed(
      this.#fork, world.info ? server.access.why_not("fork_world", world.shown) : common_texts.no_world,
      texts.fork_help);
    set_allowed(
      this.#remove,
      !world.info && !server.worlds.damage_of(world.name) ? common_texts.no_world :
        world.is_replay                                   ? texts.return_first :
                                                            server.access.why_not("delete_world", world.name));
    const is_member = server.access.membership !== null;
    this.#create.hidden = is_member;
    set_text(this.#why, is_member ? "" : why_create);
    if (why_create && !is_member) {
      this.#confirm.element.hidden = this.#fork_form.element.hidden = true;
    }
    this.#islands.refresh();
  }

  /** subject: {create: true} or {fork: true} */
  show(subject: {[key: string]: unknown}): void {
    if (subject.create) {
      this.#open_dialog();
    } else if (subject.fork) {
      this.#ask_fork();
    }
  }

  #world_rows(): TableRow[] {
    const {server} = this.#context, world = this.#context.world();
    const row = (name: string, cells: string[]): TableRow =>
      ({name, chosen: name === world.name, act: () => this.#context.world().show(name), cells});
    const listed = server.worlds.all.filter((one) => !one.replay || one.name === world.name);
    return [
      ...listed.map((info) => {
        const live = info.name === world.shown && world.feed.reading?.info;
        return row(info.name, [
          state_word(live ? world.control.state : info.state, server.storage, info.awaited_fitness !== undefined),
          with_separators(live ? live.generation : info.generation ?? 0),
          with_separators(live ? live.tick : info.tick ?? 0),
          info.slowed ? texts.slower(speed_text(info.speed)) : speed_text(info.speed)
        ]);
      }),
      ...server.worlds.damaged.map(({name}) => row(name, [texts.damaged, "", "", ""]))
    ];
  }

  #open_dialog(): void {
    void this.#context.attempt(async () => await new_world_dialog(this.#context).open());
  }

  #ask_delete(): void {
    this.#deleted = this.#context.world().name;
    set_text(this.#question, texts.ask_remove(this.#deleted));
    this.#fork_form.element.hidden = true;
    this.#confirm.open();
  }

  async #do_delete(): Promise<void> {
    this.#confirm.close();
    await this.#context.attempt(() => this.#context.server.request("delete_world", {world: this.#deleted}));
  }

  #ask_fork(): void {
    const world = this.#context.world(), why = this.#context.server.access.why_not("fork_world", world.shown);
    if (why || !world.snapshot) {
      this.#context.notify(
        why || common_texts.no_world,
        () => why === "" ? !world.snapshot : this.#context.server.access.why_not("fork_world", world.shown) === why);
      return;
    }
    if (world.info?.class) { // the rules of classes determine the name
      void this.#context.fork();
      return;
    }
    set_text(this.#fork_from, texts.fork_from(world.shown, world.snapshot.generation, world.feed.tick));
    set_text(this.#fork_error, "");
    this.#fork_name.value = unused_name(world.name, this.#context.server.worlds.names);
    this.#confirm.element.hidden = true;
    this.#fork_form.open();
  }

  async #do_fork(): Promise<void> {
    const name = this.#fork_name.value.trim(), problem = name_problem(name);
    set_text(this.#fork_error, problem);
    if (problem) {
      return;
    }
    try {
      await this.#context.fork(name);
      this.#fork_form.close();
    } catch (error) {
      set_text(this.#fork_error, (error as Error).message);
    }
  }
}
