// App: the layout of the page: one or two worlds at the left, the docked column at the right, banners above, notices below.
import type {Message, RequestKind} from "../core/messages";
import {panels} from "../panels/all";
import {unused_name} from "../panels/new_world";
import {Column} from "./column";
import {set_attribute} from "../widgets/controls";
import {copy_text} from "../widgets/copy";
import {h} from "../widgets/dom";
import {event_text, noticed_events} from "../world/event_text";
import {FitnessCurve} from "../plots/fitness_curve";
import {LinkFollower} from "./link_follower";
import {link_of} from "../world/link";
import {Help, type KeyTarget, listen_to_keys} from "./keys";
import {Banners, Notices, type Banner} from "../widgets/notices";
import {PaneArea} from "./pane_area";
import type {Server} from "../world/server";
import {of_browser} from "../world/storage";
import {session_text, storage_text} from "../texts/texts";
import {theme_button} from "../widgets/theme";
import type {Tokens} from "../world/tokens";
import {Tools} from "./tools";
import {ViewedWorld} from "../world/world";

const first_world = "default"; // shown first if the server has it

export class App implements KeyTarget {
  readonly element: HTMLElement;
  readonly column: Column;
  readonly areas: PaneArea[] = [];

  #focused = 0;
  #last_pane = -1;
  #worlds: HTMLElement;
  #empty: HTMLElement;
  #banners = new Banners();
  #notices = new Notices();
  #help = new Help(this);
  #link = new LinkFollower(this, () => this.#refresh());
  #curve: FitnessCurve;
  #show_column: HTMLButtonElement;

  readonly #tokens: Tokens;

  constructor(readonly server: Server, tokens: Tokens) {
    this.#tokens = tokens;
    this.#empty = h(
      "div", {class: "empty"}, h("p", {}, "The server has no world yet."),
      h("button", {type: "button", class: "button button-primary", onclick: () => this.open("worlds", {create: true})},
        "New world …"));
    this.#worlds = h("main", {class: "worlds", id: "worlds", tabindex: -1});
    this.#add_area();
    this.#curve = new FitnessCurve((generation) => void this.attempt(() => this.world().past.show(generation)));
    const hide =
      h("button", {
        type: "button",
        class: "button button-quiet square wide-only",
        "aria-label": "Hide the column",
        title: "Hide the column (D)",
        onclick: () => this.toggle_column()
      },
        "»");
    this.#show_column =
      h("button", {
        type: "button",
        class: "button square show-column",
        "aria-label": "Show the column",
        title: "Show the column (D)",
        onclick: () => this.toggle_column()
      },
        "«");
    const help =
      h("button", {
        type: "button",
        class: "button button-quiet square",
        "aria-label": "Keys and gestures",
        title: "Keys and gestures (?)",
        onclick: () => this.toggle_help()
      },
        "?");
    this.column = new Column(
      this, server, panels.map((make) => make(this)), new Tools(() => this.area().pane, this.notify),
      [theme_button(), help, hide]);
    this.column.curve.append(this.#curve.element);
    this.element =
      h("div", {class: "app"},
        h("a", {class: "button skip", href: "#worlds", onclick: (event: Event) => this.#skip(event)},
          "Skip to the world"),
        this.#banners.element, this.#worlds, this.#show_column, this.column.element, this.#notices.element);
    set_attribute(this.element, "data-column", of_browser.get("column") === "collapsed" ? "collapsed" : "shown");
    server.on_change(() => this.#refresh());
    server.on_event((event) => this.#announce(event));
    listen_to_keys(this);
    this.#refresh();
    this.follow_link(location.hash);
  }

  /** Shows the moment that the fragment of an address names; does nothing if it names none. */
  follow_link(hash: string): void {
    void this.#link.follow(hash);
  }

  /** Shows the present state. */
  refresh(): void {
    this.#refresh();
  }

  // ---- PanelContext ----

  /** The world of the pane with the focus. */
  world(): ViewedWorld {
    return this.area().world;
  }

  /** The world of the other pane if two are shown side by side. */
  other(): ViewedWorld|null {
    return this.areas.find((_area, i) => i !== this.#focused)?.world ?? null;
  }

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

  notify = (text: string): void => this.#notices.show(text);

  attempt = async(what: () => Promise<unknown>): Promise<boolean> => {
    try {
      await what();
      return true;
    } catch (error) {
      this.notify(error instanceof Error ? error.message : String(error));
      return false;
    }
  };

  // ---- panes ----

  area(): PaneArea {
    return this.areas[this.#focused]!;
  }

  /** Shows a world in the other half, and focuses it. */
  show_beside(world: string, island = 0): ViewedWorld {
    const area = this.areas[1 - this.#focused] ?? this.#add_area();
    area.world.show(world, island);
    this.#focus(area);
    return area.world;
  }

  /** Shows a second world; or, if two are shown, only the focused one. The second one is the world that was forked
   *  last; else the live world of a replay; else the next world of the list; else the past of the only world. */
  toggle_beside(): void {
    if (this.areas.length > 1) {
      this.#close_area(this.areas[1 - this.#focused]!);
      return;
    }
    const server = this.server, shown = this.world(), {name, island} = shown;
    const names = server.world_names;
    const next = names[(names.indexOf(name) + 1) % names.length];
    if (shown.past.forked && server.world(shown.past.forked)) {
      this.show_beside(shown.past.forked, island);
    } else if (shown.past.is_own_replay) {
      this.show_beside(name, island);
    } else if (next !== undefined && next !== name) {
      this.show_beside(next);
    } else if (shown.past.problem) {
      this.notify(shown.past.problem);
    } else {
      const generation = shown.snapshot?.generation ?? 1, past = this.show_beside(name, island);
      void this.attempt(() => past.past.show(generation));
    }
  }

  fork = async(name?: string): Promise<void> => {
    const server = this.server, world = this.world(), {island} = world;
    const fork = name ?? unused_name(world.name, server.world_names);
    const act = (): Promise<unknown> => server.request("fork_world", {world: world.shown, name: fork});
    if (name !== undefined) {
      await act();
    } else if (!(await this.attempt(act))) {
      return;
    }
    world.past.forked = fork;
    this.notify(`Forked the world ${fork} from this moment`);
    this.show_beside(fork, island);
  };

  // ---- links ----

  /** The link to the moment that a world shows; empty before the first snapshot. */
  link(world = this.world()): string {
    const {snapshot} = world;
    return !snapshot ? "" : link_of(location.origin + location.pathname, {
      world: world.name,
      generation: snapshot.generation,
      tick: snapshot.generation_tick,
      island: snapshot.island_count > 1 ? snapshot.island : null,
      organism: world.selection.id,
      rate: world.feed.has_rate ? world.feed.rate_hz : null,
    });
  }

  copy_link = (world: ViewedWorld): void => {
    const link = this.link(world);
    if (link) {
      void copy_text(link, "Link to this moment").then((copied) => copied && this.notify(`Copied ${link}`));
    }
  };

  focus_other(): void {
    const other = this.areas.find((_area, i) => i !== this.#focused);
    if (other) {
      this.#focus(other);
    }
  }

  #add_area(): PaneArea {
    const world = new ViewedWorld(this.server, ++this.#last_pane);
    const area: PaneArea = new PaneArea(world, {
      worker: this.server,
      notify: this.notify,
      attempt: this.attempt,
      copy_link: this.copy_link,
      on_focus: () => this.#focus(area),
      on_tool: () => this.#refresh(),
      on_select: () => this.#show_organism(),
      beside: () => (this.areas.length > 1 ? this.#close_area(area) : this.toggle_beside()),
    });
    for (const event of ["pointerdown", "focusin"]) { // before the controls of the pane act
      area.element.addEventListener(event, () => this.#focus(area), {capture: true});
    }
    this.areas.push(area);
    this.#worlds.append(area.element);
    world.changes.listen(() => {
      if (this.areas.length > 0 && this.world() === world) {
        this.#refresh_column();
      }
    });
    return area;
  }

  #close_area(area: PaneArea): void {
    const other = this.areas.find((one) => one !== area)!;
    this.areas.splice(this.areas.indexOf(area), 1);
    area.close();
    this.#focus(other);
  }

  /** Shows the organism that the user has selected in a pane, unless the column is hidden. */
  #show_organism(): void {
    if (this.element.dataset.column !== "collapsed") {
      this.open("organism");
    }
  }

  #focus(area: PaneArea): void {
    const index = this.areas.indexOf(area), are_two = this.areas.length > 1;
    if (index < 0) {
      return; // the pane is being closed
    }
    this.#focused = index;
    set_attribute(this.#worlds, "data-panes", String(this.areas.length));
    for (const one of this.areas) {
      set_attribute(one.element, "data-focused", are_two ? String(one === area) : null);
      set_attribute(one.element, "aria-current", are_two && one === area ? "true" : null);
      one.set_beside(are_two);
    }
    this.#refresh_column();
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
    this.#help.toggle();
  }

  #skip(event: Event): void {
    event.preventDefault();
    (this.area().element.querySelector<HTMLElement>("canvas, [tabindex]") ?? this.#worlds).focus();
  }

  #refresh(): void {
    this.#banners.set(this.#wrong());
    const server = this.server, names = server.world_names;
    const first = names.includes(first_world) ? first_world : names[0];
    if (server.worlds_known && !this.areas[0]!.world.name && first !== undefined) {
      this.areas[0]!.world.show(first);
    }
    const ended = this.areas.length > 1 && this.areas.find((area) => area.world.name === ""); // its world was deleted
    if (ended) {
      this.#close_area(ended);
    }
    const empty = server.worlds_known && names.length === 0;
    this.areas.forEach((area) => (area.element.hidden = empty));
    if (empty && !this.#empty.isConnected) {
      this.#worlds.append(this.#empty);
    } else if (!empty) {
      this.#empty.remove();
    }
    this.#refresh_column();
  }

  #refresh_column(): void {
    if (this.column as Column | undefined) { // the first pane is there before the column
      this.column.refresh();
      this.#curve.update(this.world());
      document.title = this.world().name ? `${this.world().name} – evod` : "evod";
    }
  }

  /** Reports what others have done to a world that is shown. */
  #announce(event: Message): void {
    const kind = Object.keys(noticed_events).find((name) => event[name] !== undefined);
    const shown = this.areas.some((area) => area.world.name === event.world || area.world.shown === event.world);
    if (kind && shown && !noticed_events[kind]!.some((command) => this.server.has_sent(command as RequestKind, event.world))) {
      this.notify(event_text(event)[0] + ".");
    }
  }

  /** Asks whether to use the token of a link. */
  #other_token(): Banner[] {
    const server = this.server, tokens = this.#tokens;
    if (tokens.offered === null || server.state.phase !== "open") {
      return [];
    }
    const use = (): void => server.connect(tokens.use(tokens.offered!)), keep = (): void => {
      tokens.decline();
      this.#refresh();
    };
    return [{
      name: "token",
      kind: "warn",
      text: `The link contains another token. You are connected as ${session_text(server.state.welcome)}.`,
      actions: [{label: "Use the token of the link", act: use}, {label: "Keep mine", act: keep}]
    }];
  }

  #wrong(): Banner[] {
    const server = this.server, {phase, message} = server.state, storage = storage_text(server.storage);
    const reload = {label: "Reload", act: () => location.reload()};
    return [
      ...(
        phase === "lost" || phase === "connecting" ? [{
          name: "lost",
          kind: "bad" as const,
          text: server.going_away ? "The server has shut down. Trying again …" :
                                    `${message || "Connecting"}. Trying again …`
        }] :
                                                     []),
      ...(
        phase === "open" && server.going_away ?
          [{name: "going", kind: "warn" as const, text: "The server is shutting down."}] :
          []),
      ...(
        server.updated ? [{
          name: "updated",
          kind: "warn" as const,
          text: "The server was updated: reload the page.",
          actions: [reload]
        }] :
                         []),
      ...this.#other_token(),
      ...this.#link.banners(),
      ...(storage ? [{name: "storage", kind: "bad" as const, text: storage}] : []),
    ];
  }
}
