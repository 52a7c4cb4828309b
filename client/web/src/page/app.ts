// App: the layout of the page: one or two worlds at the left, the docked column at the right, banners above, notices
// below.
import {kind_of} from "../core/messages";
import type {Event as WorldEvent, WorldInfo} from "../core/protocol";
import {class_panel, panels} from "../panels/all";
import {ClassMode} from "./class_mode";
import {Column} from "./column";
import {set_attribute} from "../widgets/controls";
import {copy_text} from "../widgets/copy";
import {h, set_text} from "../widgets/dom";
import {event_text, noticed_events} from "../world/event_text";
import {EvolutionButton} from "./evolution_button";
import {Introduction} from "./introduction";
import {LinkFollower} from "./link_follower";
import {chosen_lesson, lesson_in, with_lesson} from "../world/lesson_link";
import {link_of} from "../world/link";
import {fork_name} from "../world/names";
import type {PlacedModel} from "../world/panel_context";
import type {Help} from "../panels/help";
import {key_lines, type KeyTarget, last_panel_key, listen_to_keys} from "./keys";
import {Banners, Notices, type Notify} from "../widgets/notices";
import {Overview} from "./overview";
import type {PaneArea} from "./pane_area";
import {PaneAreas} from "./pane_areas";
import type {SecondWorld} from "../panels/second_world";
import type {Server} from "../world/server";
import {of_browser} from "../world/storage";
import {access_texts} from "../texts/access";
import {app_texts} from "../texts/app";
import {column_texts} from "../texts/column";
import {evolution_button_texts} from "../texts/evolution_button";
import {undo_texts} from "../texts/undo";
import {theme_button} from "../widgets/theme";
import type {Tokens} from "../world/tokens";
import {Tools} from "./tools";
import {undo} from "../world/undo_command";
import type {ViewedWorld} from "../world/world";
import {banners_of} from "./banners";

const first_world = "default"; // shown first if the server has it

export class App implements KeyTarget {
  readonly element: HTMLElement;
  readonly column: Column;
  readonly panes: PaneAreas;
  readonly evolution: EvolutionButton;
  readonly introduction: Introduction;
  readonly class_mode: ClassMode;

  readonly #empty: HTMLElement;
  readonly #about = h("p", {class: "about"});
  readonly #banners = new Banners();
  readonly #notices = new Notices();
  #help: Help|null = null;
  readonly #link = new LinkFollower(this, () => this.refresh());
  readonly #show_column: HTMLButtonElement;
  readonly #tokens: Tokens;
  #second: SecondWorld|null = null;

  constructor(readonly server: Server, tokens: Tokens) {
    this.#tokens = tokens;
    this.#empty = h(
      "div", {class: "empty"}, h("p", {}, app_texts.no_world),
      h("button", {type: "button", class: "button button-primary", onclick: () => this.open("worlds", {create: true})},
        app_texts.new_world));
    this.panes = new PaneAreas(server, {
      notify: this.notify,
      attempt: this.attempt,
      copy_link: this.copy_link,
      on_select: () => this.#show_organism(),
      on_placed: () => offer_undo(this),
      on_change: () => this.#refresh_column(),
      choose_second: () => void this.attempt(async () => {
        const {SecondWorld: Loaded} = await import("../panels/loaded_later");
        (this.#second ??= new Loaded(this)).open();
      }),
    });
    this.evolution = new EvolutionButton(this, () => this.refresh());
    this.class_mode = new ClassMode(this, () => this.refresh());
    const offer =
      h("button", {type: "button", class: "button button-primary", onclick: () => this.evolution.toggle()},
        evolution_button_texts.show);
    this.introduction = new Introduction(offer);
    const button = (label: string, name: string, help: string, classes: string, act: () => void) =>
      h("button", {type: "button", class: `button square ${classes}`, "aria-label": name, title: help, onclick: act},
        label);
    const toggle = (): void => this.toggle_column();
    const hide = button("»", app_texts.hide_column, app_texts.hide_column_help, "button-quiet wide-only", toggle);
    this.#show_column = button("«", app_texts.show_column, app_texts.show_column_help, "show-column", toggle);
    const help = button("?", app_texts.help, app_texts.help_help, "button-quiet", () => this.toggle_help());
    this.column = new Column(
      this, server, new Overview(this, this.evolution.element),
      [...panels, ...(server.access.may_teach ? [class_panel] : [])].map((make) => make(this)),
      new Tools(this, () => this.panes.focused.pane.tool), [theme_button(), help, hide]);
    this.element =
      h("div", {class: "app"},
        h("a", {class: "button skip", href: "#worlds", onclick: (event: Event) => skip_to(this.panes, event)},
          app_texts.skip),
        h("div", {class: "top"}, this.#about, this.#banners.element), this.introduction.element, this.panes.element,
        this.#show_column, this.column.element, this.#notices.element);
    set_attribute(this.element, "data-column", of_browser.get("column") === "collapsed" ? "collapsed" : "shown");
    server.changes.listen(() => this.refresh());
    server.events.listen((event) => this.#announce(event));
    listen_to_keys(this);
    this.refresh();
    this.follow_link(location.hash);
    const lesson = server.access.membership?.lesson ?? "";
    if (lesson !== "") {
      this.open("lesson", {lesson});
    }
  }

  /** Shows the moment or the class that the fragment of an address names; does nothing if it names none. */
  follow_link(hash: string): void {
    const of_class = new URLSearchParams(hash.slice(1)).get("class"), lesson = lesson_in(hash);
    if (lesson !== "") {
      this.open("lesson", {lesson});
    }
    if (of_class === null) {
      void this.#link.follow(hash);
    } else {
      this.class_mode.open(of_class);
    }
  }

  /** Shows the present state. */
  refresh(): void {
    const server = this.server, names = server.worlds.names, {areas} = this;
    this.#notices.refresh();
    const first = [server.access.membership?.world, first_world].find((name) => names.includes(name ?? "")) ?? names[0];
    if (server.worlds.are_known && !areas[0]!.world.name && first !== undefined) {
      areas[0]!.world.show(first);
    }
    const ended = areas.length > 1 && areas.find((area) => area.world.name === ""); // its world was deleted
    if (ended) {
      this.panes.close(ended);
    }
    const is_empty = server.worlds.are_known && names.length === 0;
    areas.forEach((area) => (area.element.hidden = is_empty));
    if (is_empty && !this.#empty.isConnected) {
      this.panes.element.append(this.#empty);
    } else if (!is_empty) {
      this.#empty.remove();
    }
    this.#refresh_column();
  }

  // ---- PanelContext ----

  /** The world of the pane with the focus. */
  world(): ViewedWorld {
    return this.panes.focused.world;
  }

  /** The world of the other pane if two are shown side by side. */
  other(): ViewedWorld|null {
    return this.panes.other?.world ?? null;
  }

  open_class = (name: string): void => this.class_mode.open(name);

  open = (name: string, subject?: {[key: string]: unknown}): void => {
    const panel = this.column.panels.find((one) => one.name === name);
    if (!panel) {
      return;
    }
    if (this.element.dataset.column === "collapsed") {
      this.toggle_column();
    }
    this.column.show(panel);
    if (subject) {
      panel.show?.(subject);
    }
  };

  place_by_clicks = (model: PlacedModel): (() => boolean)|null => {
    const {tool} = this.panes.focused.pane, problem = tool.place_copies_of(model);
    if (problem) {
      this.notify(problem, () => tool.problem("organism", model) === problem);
      return null;
    }
    return () => this.panes.focused.pane.tool === tool && tool.tool === "organism" && tool.model === model;
  };

  notify: Notify = (text, holds, action, stays) => {
    const take_part = {label: column_texts.take_part, act: () => this.server.access.set_taking_part(true)};
    this.#notices.show(text, holds, text === access_texts.watching ? take_part : action, stays);
  };

  attempt = async(what: () => Promise<unknown>): Promise<boolean> => {
    this.#notices.forget_refusal();
    try {
      await what();
      return true;
    } catch (error) {
      const holds = (): boolean => this.server.state.phase !== "open"; // the request failed for that reason
      this.notify(error instanceof Error ? error.message : String(error), holds() ? holds : undefined, undefined, true);
      return false;
    }
  };

  // ---- panes ----

  get areas(): readonly PaneArea[] {
    return this.panes.all;
  }

  show_beside(world: string, island = 0): ViewedWorld {
    return this.panes.show_beside(world, island);
  }

  show_second(world: string, island = 0): ViewedWorld {
    return this.panes.show_second(world, island);
  }

  fork = async(name?: string): Promise<void> => {
    const server = this.server, world = this.world(), {island} = world;
    const origin = server.worlds.find(world.name) ?? {name: world.name};
    const fork = name ?? fork_name(origin, server.worlds.taken_names);
    let begin: WorldInfo = {};
    const act = async(): Promise<void> => {
      begin = await server.request("fork_world", {world: world.shown, name: fork});
    };
    if (name !== undefined) {
      await act();
    } else if (!(await this.attempt(act))) {
      return;
    }
    world.past.forked = fork;
    this.notify(app_texts.forked(fork));
    this.show_beside(fork, island).past.begin(begin);
  };

  // ---- links ----

  /** The link to the moment that a world shows; empty before the first snapshot. */
  link(world = this.world()): string {
    const {snapshot} = world;
    const link = !snapshot ? "" : link_of(location.origin + location.pathname, {
      world: world.name,
      generation: snapshot.generation,
      tick: snapshot.generation_tick,
      island: snapshot.island_count > 1 ? snapshot.island : null,
      organism: world.selection.id,
      rate: world.feed.has_rate ? world.feed.rate_hz : null,
    });
    return with_lesson(link, chosen_lesson());
  }

  reload(): void {
    const {name, past, snapshot} = this.world();
    const link = past.is_own_replay ? this.link() : with_lesson(link_of(location.origin + location.pathname, {
      world: name,
      generation: null,
      tick: null,
      island: snapshot && snapshot.island_count > 1 ? snapshot.island : null,
      organism: null,
      rate: null,
    }), chosen_lesson());
    if (link) {
      history.replaceState(null, "", link);
    }
    location.reload();
  }

  copy_link = (world: ViewedWorld): void => {
    const link = this.link(world);
    if (link) {
      void copy_text(link, app_texts.link).then((copied) => copied && this.notify(app_texts.copied(link)));
    }
  };

  /** Shows the organism that the user has selected in a pane, unless the column is hidden. */
  #show_organism(): void {
    if (this.element.dataset.column !== "collapsed") {
      this.open("organism");
    }
  }

  // ---- the page ----

  toggle_column(): void {
    const collapsed = this.element.dataset.column !== "collapsed";
    set_attribute(this.element, "data-column", collapsed ? "collapsed" : "shown");
    of_browser.set("column", collapsed ? "collapsed" : "");
    if (collapsed) {
      this.#show_column.focus();
    }
  }

  toggle_help(): void {
    void this.attempt(async () => {
      const {Help: Loaded} = await import("../panels/loaded_later");
      const titles = this.column.panels.slice(0, last_panel_key).map(({title}) => title);
      this.#help ??= new Loaded(key_lines(), titles, () => this.introduction.begin());
      this.#help.toggle();
    });
  }

  #refresh_column(): void {
    if (this.column as Column | undefined) { // the first pane is there before the column
      this.column.refresh();
      this.introduction.refresh(this.world().has_bodies);
      this.evolution.refresh();
      const banners = banners_of(this.server, this.#tokens, this.#link, this.evolution, () => this.refresh());
      this.#banners.set([...banners, ...this.class_mode.banners()]);
      this.#notices.refresh();
      const {counts} = this.world().snapshot ?? {};
      const has_items = counts !== undefined && counts.food + counts.poison > 0;
      set_text(this.#about, app_texts.about(has_items, this.world().has_births));
      document.title = app_texts.title(this.world().name);
    }
  }

  /** Reports what others have done to a world that is shown. */
  #announce(event: WorldEvent): void {
    const kind = kind_of(event)?.kind, world = event.world ?? "";
    const commands = kind === undefined ? undefined : noticed_events[kind];
    const is_shown = this.areas.some((area) => area.world.name === world || area.world.shown === world);
    if (commands && is_shown && !commands.some((command) => this.server.has_sent(command, world))) {
      this.notify(event_text(event)[0] + ".");
    }
  }
}

/** Focuses the island that the panes show. */
function skip_to({focused, element}: PaneAreas, event: Event): void {
  event.preventDefault();
  const island = focused.element.querySelector<HTMLElement>("canvas:not([inert]), .island-tile[tabindex='0']");
  (island ?? element).focus();
}

/** Says what the user has placed, with a button that removes it again. */
function offer_undo(app: App): void {
  const world = app.world(), name = world.undo.next_undo;
  const is_last = (): boolean => app.world() === world && world.undo.next_undo === name;
  if (name !== "") {
    const act = (): void => (is_last() ? void undo(app, "undo") : app.notify(undo_texts.not_last(name)));
    app.notify(undo_texts.done(name), undefined, {label: undo_texts.undo, act});
  }
}
