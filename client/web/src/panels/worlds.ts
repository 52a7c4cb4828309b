// WorldsPanel: the worlds of the server with their state, the islands of the shown world, and the commands that create,
// fork and delete worlds.
import {common_texts} from "../texts/common";
import {tenths, with_separators} from "../texts/numbers";
import {speed_text, state_word} from "../texts/texts";
import {worlds_texts as texts} from "../texts/worlds";
import {guarded_button, set_allowed} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";

import type {Statistics} from "../core/protocol";
import {name_problem, unused_name} from "../world/names";
import type {Panel, PanelContext} from "../world/panel_context";

import {update_rows} from "./rows";

const poll_ms = 1000;

export class WorldsPanel implements Panel {
  readonly name = "worlds";
  readonly title = texts.title;
  readonly element: HTMLElement;

  #worlds = h("tbody", {});
  #islands = h("tbody", {});
  #islands_title = h("h3", {});
  #islands_table: HTMLElement;
  #create: HTMLButtonElement;
  #fork: HTMLButtonElement;
#delete : HTMLButtonElement;
  #why = h("p", {class: "hint"});
  #confirm: HTMLElement;
  #question = h("p", {});
  #deleted = "";
  #fork_form: HTMLFormElement;
  #fork_name = h("input", {class: "field grow", "aria-label": texts.fork_name, maxlength: 64, spellcheck: "false"});
  #fork_from = h("p", {});
  #fork_error = h("p", {class: "error", role: "alert"});
  #statistics: Statistics|null = null;
  #polled = 0;
  #pending = false;

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    const {notify} = context;
    this.#create = guarded_button(texts.create, notify, () => this.#open_dialog());
    this.#fork = guarded_button(texts.fork, notify, () => this.#ask_fork());
    this.#delete = guarded_button(texts.remove, notify, () => this.#ask_delete());
    this.#confirm =
      h("div", {class: "confirm", hidden: true}, this.#question, h("p", {class: "hint"}, texts.file_stays),
        h("div", {class: "row"},
          h("button", {type: "button", class: "button button-danger", onclick: () => void this.#do_delete()},
            texts.do_remove),
          h("button", {type: "button", class: "button", onclick: () => this.#close(this.#confirm, this.#delete)},
            common_texts.cancel)));
    this.#fork_form =
      h("form", {
        class: "confirm",
        hidden: true,
        onsubmit: (event: Event) => {
          event.preventDefault();
          void this.#do_fork();
        }
      },
        this.#fork_from,
        h("div", {class: "row"}, this.#fork_name,
          h("button", {type: "submit", class: "button button-primary"}, texts.do_fork),
          h("button", {type: "button", class: "button", onclick: () => this.#close(this.#fork_form, this.#fork)},
            common_texts.cancel)),
        this.#fork_error);
    this.#islands_table =
      h("table", {class: "table"},
        h("thead", {},
          h("tr", {},
            ...texts.island_headings.map((text, i) => h("th", {scope: "col", class: i ? "number" : null}, text)))),
        this.#islands);
    this.element =
      h("div", {class: "panel panel-worlds"},
        h("table", {class: "table"},
          h("thead", {},
            h("tr", {},
              ...texts.headings.map((text, i) => h("th", {scope: "col", class: i > 1 ? "number" : null}, text)))),
          this.#worlds),
        h("div", {class: "row"}, this.#create, this.#fork, this.#delete), this.#why, this.#confirm, this.#fork_form,
        this.#islands_title, this.#islands_table);
  }

  refresh(): void {
    const {server} = this.#context, world = this.#context.world();
    const damaged = server.damaged.map(({name}) => ({
                                         name,
                                         chosen: name === world.name,
                                         act: () => this.#context.world().show(name),
                                         cells: [texts.damaged, "", "", ""]
                                       }));
    update_rows(
      this.#worlds,
      [
        ...server.worlds.filter((one) => !one.replay || one.name === world.name).map((info) => {
          const live = info.name === world.shown && world.snapshot;
          return {
            name: info.name,
            chosen: info.name === world.name,
            act: () => this.#context.world().show(info.name),
            cells: [
              state_word(live ? world.control.state : info.state ?? "", server.storage, info.awaited_fitness !== undefined),
              with_separators(live ? live.generation : info.generation ?? 0),
              with_separators(live ? live.tick : info.tick ?? 0),
              info.slowed ? texts.slower(speed_text(info.speed)) : speed_text(info.speed)
            ],
          };
        }),
        ...damaged
      ],
      1);
    const why_create = server.why_not("create_world");
    set_allowed(this.#create, why_create, texts.create_help);
    set_allowed(this.#fork, world.info ? server.why_not("fork_world") : common_texts.no_world, texts.fork_help);
    set_allowed(
      this.#delete,
      !world.info && !server.damage_of(world.name) ? common_texts.no_world :
        world.is_replay                            ? texts.return_first :
                                                     server.why_not("delete_world"));
    set_text(this.#why, why_create);
    if (why_create) {
      this.#confirm.hidden = this.#fork_form.hidden = true;
    }
    const statistics = this.#statistics, count = statistics?.world?.island_count ?? 0;
    this.#islands_title.hidden = this.#islands_table.hidden = count === 0 || statistics?.world?.name !== world.shown;
    if (statistics && !this.#islands_table.hidden) {
      set_text(this.#islands_title, world.is_replay ? texts.islands_of_replay(world.name) : texts.islands(world.name));
      const of = <Row extends {island?: number}>(all: Row[]|undefined, island: number): Row|undefined =>
        all?.find((one) => (one.island ?? 0) === island);
      update_rows(this.#islands, Array.from({length: count}, (_, i) => {
        const live = of(statistics.live, i), last = of(statistics.last, i);
        return {
          name: texts.island(i),
          chosen: i === world.island,
          act: () => this.#context.world().choose_island(i),
          cells: [
            live ? texts.alive(live.alive_count ?? 0, live.organism_count ?? 0) : "",
            live ? tenths(live.health_mean ?? 0) : "", last ? tenths(last.fitness_best ?? 0) : ""
          ],
        };
      }), 0);
    }
    this.#poll();
  }

  /** subject: {create: true} or {fork: true} */
  show(subject: {[key: string]: unknown}): void {
    if (subject.create) {
      this.#open_dialog();
    } else if (subject.fork) {
      this.#ask_fork();
    }
  }

  /** Asks for statistics while the panel is shown: events do not report the progress of a generation. */
  #poll(): void {
    const world = this.#context.world();
    if (
      this.#pending || !world.shown || world.server.state.phase !== "open" ||
      performance.now() < this.#polled + poll_ms && this.#statistics?.world?.name === world.shown) {
      return;
    }
    this.#pending = true;
    this.#polled = performance.now();
    const statistics = world.server.request("get_statistics", {world: world.shown})
                         .then((answer) => (this.#statistics = answer), () => undefined);
    Promise.all([statistics, world.server.refresh_worlds()]).finally(() => {
      this.#pending = false;
      if (!this.element.hidden) {
        this.refresh();
      }
    });
  }

  #open_dialog(): void {
    void this.#context.attempt(
      async () => await (await import("./loaded_later")).new_world_dialog(this.#context).open());
  }

  #ask_delete(): void {
    this.#deleted = this.#context.world().name;
    set_text(this.#question, texts.ask_remove(this.#deleted));
    this.#fork_form.hidden = true;
    this.#confirm.hidden = false;
    this.#confirm.querySelector("button")!.focus();
  }

  async #do_delete(): Promise<void> {
    this.#close(this.#confirm, this.#delete);
    await this.#context.attempt(() => this.#context.server.request("delete_world", {world: this.#deleted}));
  }

  #ask_fork(): void {
    const world = this.#context.world(), why = this.#context.server.why_not("fork_world");
    if (why || !world.snapshot) {
      this.#context.notify(why || common_texts.no_world);
      return;
    }
    set_text(this.#fork_from, texts.fork_from(world.shown, world.snapshot.generation, world.feed.tick));
    set_text(this.#fork_error, "");
    this.#fork_name.value = unused_name(world.name, this.#context.server.world_names);
    this.#confirm.hidden = true;
    this.#fork_form.hidden = false;
    this.#fork_name.select();
    this.#fork_name.focus();
  }

  async #do_fork(): Promise<void> {
    const name = this.#fork_name.value.trim(), problem = name_problem("name", name);
    set_text(this.#fork_error, problem);
    if (problem) {
      return;
    }
    try {
      await this.#context.fork(name);
      this.#close(this.#fork_form, this.#fork);
    } catch (error) {
      set_text(this.#fork_error, (error as Error).message);
    }
  }

  #close(form: HTMLElement, button: HTMLElement): void {
    form.hidden = true;
    button.focus();
  }
}
