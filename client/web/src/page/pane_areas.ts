// PaneAreas: the shown worlds, one or two next to each other, and which of them has the focus.
import {link_texts} from "../texts/pane";
import {set_attribute} from "../widgets/controls";
import {h} from "../widgets/dom";
import type {Server} from "../world/server";
import {ViewedWorld} from "../world/world";
import {LinkedViews} from "./linked_views";
import {PaneArea, type PaneAreaOptions} from "./pane_area";

export interface PaneAreasOptions extends Pick<PaneAreaOptions, "notify"|"attempt"|"copy_link"|"on_select"> {
  /** Called after a change that the column and the title show. */
  on_change(): void;
}

export class PaneAreas {
  readonly element = h("main", {class: "worlds", id: "worlds", tabindex: -1});
  readonly all: PaneArea[] = [];
  #focused = 0;
  #last_pane = -1;
  readonly #linked = new LinkedViews(() => this.all.map(({pane}) => pane.view));
  readonly #server: Server;
  readonly #options: PaneAreasOptions;

  constructor(server: Server, options: PaneAreasOptions) {
    this.#server = server;
    this.#options = options;
    this.#add();
  }

  get focused(): PaneArea {
    return this.all[this.#focused]!;
  }

  get other(): PaneArea|null {
    return this.all.find((_area, i) => i !== this.#focused) ?? null;
  }

  focus_other(): void {
    if (this.other) {
      this.#focus(this.other);
    }
  }

  /** Shows a world in the other half, and focuses it. */
  show_beside(world: string, island = 0): ViewedWorld {
    const area = this.other ?? this.#add();
    area.world.show(world, island);
    this.#focus(area);
    return area.world;
  }

  /** Shows a second world; or, if two are shown, only the focused one. The second one is the world that was forked
   *  last; else the live world of a replay; else the next world of the list; else the past of the only world. */
  toggle_beside(): void {
    if (this.other) {
      this.close(this.other);
      return;
    }
    const server = this.#server, shown = this.focused.world, {name, island} = shown;
    const names = server.world_names;
    const next = names[(names.indexOf(name) + 1) % names.length];
    if (shown.past.forked && server.world(shown.past.forked)) {
      this.show_beside(shown.past.forked, island);
    } else if (shown.past.is_own_replay) {
      this.show_beside(name, island);
    } else if (next !== undefined && next !== name) {
      this.show_beside(next);
    } else if (shown.past.problem) {
      const {problem} = shown.past;
      this.#options.notify(problem, () => shown.past.problem === problem);
    } else {
      const generation = shown.snapshot?.generation ?? 1, past = this.show_beside(name, island);
      void this.#options.attempt(() => past.past.show(generation));
    }
  }

  /** Makes both views move together, or each by itself. */
  toggle_link(): void {
    if (!this.other) {
      this.#options.notify(link_texts.one_world, () => this.other === null);
      return;
    }
    this.#linked.toggle(this.focused.pane.view);
    this.#refresh_heads();
    const {is_on} = this.#linked;
    this.#options.notify(
      is_on ? link_texts.linked : link_texts.unlinked, () => this.other !== null && this.#linked.is_on === is_on);
  }

  close(area: PaneArea): void {
    const other = this.all.find((one) => one !== area)!;
    this.all.splice(this.all.indexOf(area), 1);
    area.close();
    this.#linked.forget();
    this.#focus(other);
  }

  #add(): PaneArea {
    const world = new ViewedWorld(this.#server, ++this.#last_pane);
    const area: PaneArea = new PaneArea(world, {
      ...this.#options,
      worker: this.#server,
      on_focus: () => this.#focus(area),
      on_tool: () => this.#options.on_change(),
      on_view: (view, why) => {
        if (why === "moved") {
          this.#linked.moved(view);
        } else if (this.other) { // the second world has arrived: it shows what the first one shows
          this.#linked.moved(this.all.find(({pane}) => pane.view !== view)!.pane.view);
          this.#refresh_heads();
        }
      },
      beside: () => (this.other ? this.close(area) : this.toggle_beside()),
      link: () => this.toggle_link(),
    });
    for (const event of ["pointerdown", "focusin"]) { // before the controls of the pane act
      area.element.addEventListener(event, () => this.#focus(area), {capture: true});
    }
    this.all.push(area);
    this.element.append(area.element);
    world.changes.listen(() => {
      if (this.focused.world === world) {
        this.#options.on_change();
      }
    });
    return area;
  }

  #focus(area: PaneArea): void {
    const index = this.all.indexOf(area);
    if (index >= 0) { // it is not being closed
      this.#focused = index;
      this.#refresh_heads();
      this.#options.on_change();
    }
  }

  #refresh_heads(): void {
    const are_two = this.all.length > 1;
    set_attribute(this.element, "data-panes", String(this.all.length));
    for (const area of this.all) {
      const is_focused = area === this.focused;
      set_attribute(area.element, "data-focused", are_two ? String(is_focused) : null);
      set_attribute(area.element, "aria-current", are_two && is_focused ? "true" : null);
      area.set_beside(are_two, this.#linked.is_on);
    }
  }
}
