// ClassMode: the wall of a class over the page, the way back to it, and the link of a class that a user follows who is
// connected already.
import type {ClassWall} from "../class/wall";
import {app_texts} from "../texts/app";
import type {Banner} from "../widgets/notices";
import type {PanelContext} from "../world/panel_context";
import type {PaneArea} from "./pane_area";

export interface ClassModeContext extends PanelContext {
  readonly element: HTMLElement;
  readonly areas: readonly PaneArea[];
}

export class ClassMode {
  readonly #context: ClassModeContext;
  readonly #on_change: () => void;
  #wall: ClassWall|null = null;
  #from: {name: string; world: string; student: string}|null = null; // the wall from which a world was opened
  #join: (() => void)|null = null; // joins the class of a link

  /** on_change: called after banners() has changed. */
  constructor(context: ClassModeContext, on_change: () => void) {
    this.#context = context;
    this.#on_change = on_change;
  }

  /** Shows the wall of a class. world: whose tile gets the focus; empty: the first one. */
  open(name: string, world = ""): void {
    const {server, element, areas, attempt} = this.#context;
    void attempt(async () => {
      const {ClassWall: Loaded} = await import("../panels/loaded_later");
      this.#wall?.close();
      this.#from = null;
      const wall = this.#wall = new Loaded(name, {
        server,
        look: () => this.#context.world().look,
        open_world: (opened, student) => {
          this.#from = {name, world: opened, student};
          this.#context.world().show(opened);
          this.#on_change();
        },
        closed: () => this.#closed(),
      });
      history.replaceState(null, "", `#class=${name}`);
      areas.forEach((area) => area.world.feed.unsubscribe());
      element.hidden = true;
      await wall.open();
      wall.focus(world);
    });
  }

  /** Returns to the wall from which a world was opened, if there is one. */
  back(): void {
    if (this.#from !== null) {
      this.open(this.#from.name, this.#from.world);
    }
  }

  /** Asks whether to join the class of a link. */
  offer(join: () => void): void {
    this.#join = join;
    this.#on_change();
  }

  banners(): Banner[] {
    const banners: Banner[] = [], join = this.#join, from = this.#from;
    if (join !== null) {
      const actions = [
        {label: app_texts.join_class, act: () => this.#answer(join)},
        {label: app_texts.stay, act: () => this.#answer(null)}
      ];
      banners.push({name: "join", kind: "warn", text: app_texts.other_class, actions});
    }
    if (from !== null && from.world === this.#context.world().name) {
      const text = app_texts.student_world(from.student, from.name);
      const actions = [{label: app_texts.back_to_class, act: () => this.back()}];
      banners.push({name: `class ${from.world}`, kind: "info", text, actions});
    }
    return banners;
  }

  #answer(join: (() => void)|null): void {
    this.#join = null;
    this.#on_change();
    join?.();
  }

  #closed(): void {
    this.#wall = null;
    history.replaceState(null, "", location.pathname + location.search);
    this.#context.element.hidden = false;
    this.#context.areas.forEach((area) => area.world.shown !== "" && area.world.feed.subscribe());
    this.#on_change();
  }
}
