// FamilyDrawing: the family tree as one control: a canvas for the tree, and one above it for what the pointer or the
// keyboard points at, so that pointing paints only a few lines.
//
// Keyboard  One tab stop. Arrow keys move between relatives, Home and End to the ends of a row, Enter shows the moment,
//           M marks, + − 0 zoom.
import type {Place} from "../family/spot";
import {neighbour} from "../family/tree";
import {set_attribute} from "../widgets/controls";
import {h} from "../widgets/dom";
import {on_theme_change} from "../widgets/theme";
import {moved, type Range, revealed, zoomed} from "../widgets/visible_range";
import {wheel_notches} from "../widgets/wheel";
import {FamilyLayout, FamilyPainter, same_scene, type Scene, theme_of} from "./family_canvas";

const reach_px = 24; // a pointer this near to an organism points at it
const zoom_of_key = 1.5, zoom_of_notch = 1.25;
const drag_px = 4; // a shorter movement is a click
const organisms_min = 8; // the fewest in the width

export interface FamilyActions {
  /** An organism is to be read: the pointer or the keyboard points at it; null: none. */
  read(at: Place|null): void;
  /** Shows the moment of an organism. */
  go_to(at: Place): void;
  mark(at: Place): void;
}

export class FamilyDrawing {
  readonly element: HTMLElement;
  /** The organism that the keyboard points at; null before the first scene. */
  at: Place|null = null;

  readonly #base = h("canvas", {"aria-hidden": "true"}); // the panel has a table of the same organisms
  readonly #upper = h("canvas", {"aria-hidden": "true"});
  readonly #cursor =
    h("span", {class: "family-cursor"}); // at the organism that the keyboard points at, to scroll there
  readonly #actions: FamilyActions;
  #scene: Scene|null = null;
  #layout: FamilyLayout|null = null;
  #view: Range = {min: 0, max: 1}; // in units of the tree
  #pointed_at: Place|null = null;
  #drag: {pointer: number; x: number; view: Range; moved: boolean}|null = null;
  #request = 0;

  constructor(actions: FamilyActions) {
    this.#actions = actions;
    this.element =
      h("div", {
        class: "family-drawing",
        tabindex: 0,
        role: "application",
        onkeydown: (event: KeyboardEvent) => this.#press(event),
        onclick: (event: MouseEvent) => this.#click(event),
        onpointerdown: (event: PointerEvent) => this.#begin_drag(event),
        onpointermove: (event: PointerEvent) => this.#point(event),
        onpointerup: () => this.#end_drag(),
        onpointercancel: () => this.#end_drag(),
        onpointerleave: () => this.#set_pointed_at(null),
        onwheel: (event: WheelEvent) => this.#wheel(event),
        onfocus: () => {
          this.#paint_upper();
          this.#actions.read(this.at);
        },
        onblur: () => this.#paint_upper(),
      },
        this.#base, this.#upper, this.#cursor);
    on_theme_change(() => this.#paint_soon());
  }

  /** Shows a scene. A scene of another tree shows its whole width, and points at its first organism of the last row. */
  show(scene: Scene|null, label: string): void {
    if (scene?.tree !== this.#scene?.tree) {
      this.#pointed_at = null;
      this.at = scene && {row: scene.tree.rows.length - 1, place: 0};
      this.#view = whole_width(scene);
    }
    const before = this.#scene;
    this.#scene = scene;
    set_attribute(this.element, "aria-label", label);
    if (scene && !(before && same_scene(before, scene))) {
      this.#paint_soon();
    }
  }

  zoom(factor: number): void {
    const spot = this.at && this.#scene?.tree.rows[this.at.row]?.[this.at.place];
    if (spot) {
      this.#zoom_at(spot.x, factor);
    }
  }

  /** Shows the whole width. */
  fit(): void {
    this.#set_view(whole_width(this.#scene));
  }

  /** Zooms so that this position in the tree stays where it is, or at the nearer end if it is not visible. */
  #zoom_at(unit: number, factor: number): void {
    const {min, max} = this.#view, whole = whole_width(this.#scene), nearest = Math.min(Math.max(unit, min), max);
    const from = moved(this.#view, unit - nearest, whole);
    this.#set_view(zoomed(from, (nearest - min) / (max - min), factor, whole, organisms_min));
  }

  #set_view(view: Range): void {
    this.#view = view;
    this.#paint_soon();
  }

  // ---- painting ----

  #paint_soon(): void {
    if (this.#request === 0) {
      this.#request = requestAnimationFrame(() => {
        this.#request = 0;
        this.#paint();
      });
    }
  }

  #paint(): void {
    const scene = this.#scene;
    if (!scene) {
      return;
    }
    const begun = performance.now();
    const layout = new FamilyLayout(scene.tree, scene.width, this.#view);
    this.#layout = layout;
    for (const canvas of [this.#base, this.#upper]) {
      canvas.width = Math.round(layout.width * devicePixelRatio);
      canvas.height = Math.round(layout.height * devicePixelRatio);
      canvas.style.width = `${layout.width}px`;
      canvas.style.height = `${layout.height}px`;
    }
    this.#painter(this.#base)?.paint();
    this.element.dataset.paintMs = (performance.now() - begun).toFixed(1); // for measurements
    this.#paint_upper();
  }

  #painter(canvas: HTMLCanvasElement): FamilyPainter|null {
    const context = canvas.getContext("2d");
    if (!context || !this.#scene || !this.#layout) {
      return null;
    }
    context.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    return new FamilyPainter(this.#layout, this.#scene, context, theme_of(this.element));
  }

  #paint_upper(): void {
    const layout = this.#layout, painter = this.#painter(this.#upper);
    if (!layout || !painter) {
      return;
    }
    this.#upper.getContext("2d")!.clearRect(0, 0, layout.width, layout.height);
    const theme = theme_of(this.element);
    if (this.at && document.activeElement === this.element) {
      painter.paint_pointed_at(this.at, theme.focus);
    }
    if (this.#pointed_at) {
      painter.paint_pointed_at(this.#pointed_at, theme.text);
    }
  }

  // ---- pointer ----

  #place_of(event: MouseEvent): Place|null {
    const box = this.#base.getBoundingClientRect();
    return this.#layout?.nearest(event.clientX - box.left, event.clientY - box.top, reach_px) ?? null;
  }

  #set_pointed_at(at: Place|null): void {
    if (at?.row === this.#pointed_at?.row && at?.place === this.#pointed_at?.place) {
      return;
    }
    this.#pointed_at = at;
    this.element.classList.toggle("pointing", at !== null);
    this.#paint_upper();
    if (at) {
      this.#actions.read(at);
    }
  }

  #begin_drag(event: PointerEvent): void {
    this.#drag =
      event.button === 0 ? {pointer: event.pointerId, x: event.clientX, view: this.#view, moved: false} : null;
  }

  #end_drag(): void {
    const drag = this.#drag;
    setTimeout(() => { // after the click that this movement causes
      this.#drag = this.#drag === drag ? null : this.#drag;
    });
  }

  #point(event: PointerEvent): void {
    const drag = this.#drag, layout = this.#layout;
    if (drag && layout && event.buttons !== 0) {
      const by = event.clientX - drag.x;
      if (!drag.moved && Math.abs(by) >= drag_px) {
        drag.moved = true;
        this.element.setPointerCapture(drag.pointer);
      }
      if (drag.moved) {
        this.#set_view(moved(drag.view, -by / layout.each, whole_width(this.#scene)));
      }
      return;
    }
    this.#set_pointed_at(this.#place_of(event));
  }

  #click(event: MouseEvent): void {
    const at = this.#drag?.moved ? null : this.#place_of(event);
    if (!at) {
      return;
    }
    this.at = at;
    this.#paint_upper();
    if (event.shiftKey) {
      this.#actions.mark(at);
    } else {
      this.#actions.go_to(at);
    }
  }

  #wheel(event: WheelEvent): void {
    const layout = this.#layout;
    if (!layout || !event.ctrlKey || event.deltaY === 0) {
      return; // the panel scrolls
    }
    event.preventDefault();
    const unit = layout.unit_at(event.clientX - this.#base.getBoundingClientRect().left);
    this.#zoom_at(unit, zoom_of_notch ** wheel_notches(event));
  }

  // ---- keyboard ----

  #press(event: KeyboardEvent): void {
    if (event.ctrlKey || event.altKey || event.metaKey || !this.at || !this.#scene) {
      return;
    }
    if (event.key.startsWith("Arrow") || event.key === "Home" || event.key === "End") {
      const {tree} = this.#scene, at = neighbour(tree, this.at, event.key, event.shiftKey);
      this.at = at;
      this.#set_view(revealed(this.#view, tree.rows[at.row]![at.place]!.x, 0.5, whole_width(this.#scene)));
      this.#cursor.style.top = `${this.#layout?.y_of(at.row) ?? 0}px`;
      this.#cursor.scrollIntoView({block: "nearest"});
      this.#actions.read(at);
    } else if (!this.#act(event.key, this.at)) {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  /** Returns whether the drawing uses this key. */
  #act(key: string, at: Place): boolean {
    switch (key) {
      case "Enter":
      case " ":
        this.#actions.go_to(at);
        return true;
      case "m":
      case "M":
        this.#actions.mark(at);
        return true;
      case "+":
      case "=":
        this.zoom(zoom_of_key);
        return true;
      case "-":
        this.zoom(1 / zoom_of_key);
        return true;
      case "0":
        this.fit();
        return true;
      default:
        return false;
    }
  }
}

function whole_width(scene: Scene|null): Range {
  return {min: 0, max: scene?.tree.width ?? 1};
}
