// PaneAreas: the shown worlds, one or two next to each other, and which of them has the focus.
import {link_texts, pane_texts} from "../texts/pane";
import {set_attribute} from "../widgets/controls";
import {h} from "../widgets/dom";
import type {Server} from "../world/server";
import {ViewedWorld} from "../world/world";
import {LinkedViews} from "./linked_views";
import {PaneArea, type PaneAreaOptions} from "./pane_area";

export interface PaneAreasOptions extends
  Pick<PaneAreaOptions, "notify"|"attempt"|"copy_link"|"on_select"|"on_placed"> {
  /** Called after a change that the column and the title show. */
  on_change(): void;
  /** Lets the user choose the second world. */
  choose_second(): void;
}

export class PaneAreas {
  readonly element = h("main", {class: "worlds", id: "worlds", tabindex: -1, "aria-label": pane_texts.shown});
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
    const area = this.#other_showing(world, island);
    this.#focus(area);
    return area.world;
  }

  /** Shows a world in the other half. The focus stays. */
  show_second(world: string, island = 0): ViewedWorld {
    const area = this.#other_showing(world, island);
    this.#focus(this.focused);
    return area.world;
  }

  #other_showing(world: string, island: number): PaneArea {
    const area = this.other ?? this.#add();
    area.world.show(world, island);
    return area;
  }

  /** Shows only the world that was shown first again. */
  close_second(): void {
    if (this.other) {
      this.close(this.all[1]!);
    }
  }

  /** are_ordered: the second world is the past of the first one, and is shown at its left. */
  set_captions(text_of: (world: ViewedWorld) => string, are_ordered: boolean): void {
    set_attribute(this.element, "data-past-first", are_ordered ? "" : null);
    this.all.forEach((area) => area.set_caption(text_of(area.world)));
  }

  /** Lets the user choose a second world; or, if two are shown, shows only the first one again. */
  toggle_beside(): void {
    if (this.other) {
      this.close_second();
    } else {
      this.#options.choose_second();
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
