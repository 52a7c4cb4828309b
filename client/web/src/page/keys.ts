// keys: the keys of the whole page; panels/help lists them. Keys of the canvas (pan, zoom) belong to Pane.
import type {RequestKind} from "../core/messages";
import type {Point} from "../render/camera";
import {app_texts} from "../texts/app";
import type {KeyLine} from "../panels/help";
import {key_texts} from "../texts/keys";
import type {PanelContext} from "../world/panel_context";
import type {Server} from "../world/server";
import {undo, undo_verb_of} from "../world/undo_command";
import type {ClassMode} from "./class_mode";
import type {Column} from "./column";
import type {EvolutionButton} from "./evolution_button";
import type {PaneAreas} from "./pane_areas";
import {toggle_replay} from "./run_bar";

/** What the keys act on. */
export interface KeyTarget extends PanelContext {
  readonly server: Server;
  readonly column: Column;
  readonly panes: PaneAreas;
  link(): string;
  toggle_column(): void;
  toggle_help(): void;
  readonly evolution: EvolutionButton;
  readonly element: HTMLElement;
  readonly class_mode: ClassMode;
}

interface Binding {
  keys: string[]; // values of KeyboardEvent.key; letters in lower case
  shown?: string; // in the help, if it differs from keys
  help: KeyLine["help"];
  act(app: KeyTarget, event: KeyboardEvent): unknown; // a promise's refusal is shown as a notice
}

export const last_panel_key = 9;

const zoom_step = 1.25, pan_px = 48;
const arrows: {[key: string]: Point} = {
  // how the drawn island moves
  ArrowLeft: {x: pan_px, y: 0},
  ArrowRight: {x: -pan_px, y: 0},
  ArrowUp: {x: 0, y: pan_px},
  ArrowDown: {x: 0, y: -pan_px}
};

const bindings: Binding[] = [
  {
    keys: [" "],
    shown: "Space",
    help: "pause",
    act: (app) => command(app, "pause", () => app.world().control.pause_or_resume())
  },
  {keys: ["."], help: "tick", act: (app) => command(app, "pause", () => app.world().control.step(1))},
  {
    keys: [">", ":"],
    shown: "Shift+.",
    help: "ticks",
    act: (app) => command(app, "pause", () => app.world().control.step(60))
  },
  {
    keys: ["+", "="],
    shown: "+",
    help: "faster",
    act: (app) => command(app, "set_speed", () => app.world().control.multiply_speed(2))
  },
  {
    keys: ["-", "_"],
    shown: "−",
    help: "slower",
    act: (app) => command(app, "set_speed", () => app.world().control.multiply_speed(0.5))
  },
  {
    keys: ["r"],
    help: "real_time",
    act: (app) => command(app, "set_speed", () => app.world().control.set_speed({real_time_factor: 1}))
  },
  {keys: ["m"], help: "maximum", act: (app) => command(app, "set_speed", () => app.world().control.toggle_max_speed())},
  {keys: ["PageDown"], shown: "Page Down", help: "next_island", act: (app) => move_island(app, 1)},
  {keys: ["PageUp"], shown: "Page Up", help: "previous_island", act: (app) => move_island(app, -1)},
  {keys: ["i"], help: "all_islands", act: (app) => app.panes.focused.toggle_tiles(app.notify)},
  {keys: ["w"], help: "next_world", act: (app) => next_world(app)},
  {keys: ["p"], help: "replay", act: (app) => toggle_replay(app, app.world())},
  {keys: ["["], help: "previous_generation", act: (app) => move_generation(app, -1)},
  {keys: ["]"], help: "next_generation", act: (app) => move_generation(app, 1)},
  {keys: ["b"], help: "beside", act: (app) => app.panes.toggle_beside()},
  {keys: ["e"], help: "evolution", act: (app) => app.evolution.toggle()},
  {keys: ["x"], help: "other_world", act: (app) => app.panes.focus_other()},
  {keys: ["k"], help: "link", act: (app) => app.panes.toggle_link()},
  {keys: ["f", "Home"], shown: "F   Home", help: "fit", act: (app) => app.panes.focused.pane.view.fit()},
  {
    keys: ["z"],
    shown: "Z   Shift+Z",
    help: "zoom",
    act: (app, event) => app.panes.focused.pane.view.zoom_by(event.shiftKey ? 1 / zoom_step : zoom_step)
  },
  {
    keys: Object.keys(arrows),
    shown: "←   →   ↑   ↓",
    help: "move",
    act: (app, event) => app.panes.focused.pane.view.pan(arrows[event.key]!)
  },
  {keys: ["l"], help: "follow", act: (app) => app.world().selection.set_follow(!app.world().selection.follow)},
  {keys: ["c"], help: "colour", act: (app) => next_colouring(app)},
  {
    keys: ["v"],
    help: "perception",
    act: (app) => app.world().set_look({perception: next_of(app.world().look.perception)})
  },
  {keys: ["g"], help: "forces", act: (app) => app.world().set_look({forces: next_of(app.world().look.forces)})},
  {keys: ["t"], help: "trails", act: (app) => app.world().set_look({trails: !app.world().look.trails})},
  {keys: ["d"], help: "column", act: (app) => app.toggle_column()},
  {keys: ["?", "h", "F1"], shown: "?   H", help: "help", act: (app) => app.toggle_help()},
  {keys: ["Escape"], shown: "Esc", help: "escape", act: (app) => escape(app)},
];

let by_pointer = false; // whether the focus was moved by a pointer last, not by a key

export function listen_to_keys(app: KeyTarget): void {
  document.addEventListener("pointerdown", () => {
    by_pointer = true;
  }, true);
  document.addEventListener("keydown", (event) => {
    if (app.element.hidden) { // the wall of a class is shown
      return;
    }
    by_pointer &&= event.key === " ";
    const verb = event.defaultPrevented || document.querySelector("dialog[open]") ? null : undo_verb_of(event);
    if (verb !== null) {
      event.preventDefault();
      void undo(app, verb);
      return;
    }
    if (event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey || keeps_key(event)) {
      return;
    }
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const number = /^[1-9]$/.test(key) ? Number(key) : 0;
    const binding = bindings.find(({keys}) => keys.includes(key));
    if (number > 0 && number <= Math.min(last_panel_key, app.column.panels.length)) {
      app.open(app.column.panels[number - 1]!.name);
    } else if (binding) {
      void app.attempt(async () => binding.act(app, event));
    } else {
      return;
    }
    event.preventDefault();
  });
  document.addEventListener("copy", (event) => {
    const is_text = event.target instanceof Element && event.target.closest("input, textarea") !== null;
    if (is_text || document.getSelection()?.isCollapsed === false || document.querySelector("dialog[open]")) {
      return; // the browser copies the selected text
    }
    const link = app.link();
    if (link && event.clipboardData) {
      event.clipboardData.setData("text/plain", link);
      event.preventDefault();
      app.notify(app_texts.copied(link));
    }
  });
}

/** Whether the focused element, or an open dialog, uses this key itself. */
function keeps_key(event: KeyboardEvent): boolean {
  const element = event.target instanceof Element ? event.target : null;
  if (document.querySelector("dialog[open]")) {
    return !(event.key === "?" || event.key.toLowerCase() === "h") ||
      element?.closest("input, textarea, select") !== null;
  }
  if (!element) {
    return false;
  }
  if (element instanceof HTMLInputElement && !["checkbox", "button"].includes(element.type)) {
    return element.type !== "range" || /^(Arrow|Page|Home|End)/.test(event.key);
  }
  if (element.closest("textarea, select, [contenteditable], [role=listbox], [role=grid]")) {
    return true;
  }
  if (/^(Arrow|Page|Home|End)/.test(event.key) && element.closest(".column")) {
    return true; // scrolls the column
  }
  if ((event.key !== " " && event.key !== "Enter") || !element.closest("button, a, summary, input, [role=button]")) {
    return false;
  }
  if (event.key === " " && by_pointer && element instanceof HTMLElement) {
    element.blur(); // the user clicked it, and now runs or pauses the world
    return false;
  }
  return true;
}

/** The names of the keys and what they do, for the help. */
export function key_lines(): KeyLine[] {
  return bindings.map(
    ({keys, shown, help}) => ({keys: shown ?? keys.map((key) => key.toUpperCase()).join("   "), help}));
}

/** Runs a command, or shows why the user may not. */
async function command(app: KeyTarget, kind: RequestKind, act: () => Promise<void>): Promise<void> {
  const world = app.world(), why = app.server.access.why_not(kind, world.shown);
  if (!world.shown) {
    return;
  }
  if (why) {
    app.notify(why, () => app.server.access.why_not(kind, world.shown) === why);
  } else if (world.control.is_over && kind !== "set_speed") {
    const {is_replay} = world;
    app.notify(
      is_replay ? key_texts.end_of_replay : key_texts.run_has_ended,
      () => world.control.is_over && world.is_replay === is_replay);
  } else {
    await act();
  }
}

function move_island(app: KeyTarget, by: number): void {
  const world = app.world(), count: number = world.info?.island_count ?? 1;
  world.choose_island((world.island + by + count) % count);
}

function next_world(app: KeyTarget): void {
  const names = app.server.worlds.names;
  if (names.length > 0) {
    app.world().show(names[(names.indexOf(app.world().name) + 1) % names.length]!);
  }
}

async function move_generation(app: KeyTarget, by: number): Promise<void> {
  const world = app.world();
  if (!world.is_replay) {
    app.notify(key_texts.is_live, () => !world.is_replay);
    return;
  }
  await world.past.move_generations(by);
}

function next_of(shown: "none"|"selected"|"all"): "none"|"selected"|"all" {
  return shown === "none" ? "selected" : shown === "selected" ? "all" : "none";
}

function next_colouring(app: KeyTarget): void {
  const world = app.world(), all = ["", "health", "lineage", ...world.gene_names.slice(0, 6)];
  const next = all[(all.indexOf(world.look.colour_by) + 1) % all.length]!;
  world.set_look({colour_by: next});
  app.notify(key_texts.colour(next), () => world.look.colour_by === next);
}

function escape(app: KeyTarget): void {
  const {tool, tiles} = app.panes.focused.pane, world = app.world();
  if (tool.tool !== "select") {
    tool.set("select");
  } else if (world.selection.id !== null) {
    world.selection.select(null);
  } else if (tiles.is_on) {
    tiles.toggle();
  } else if (!tiles.return_to_all()) {
    app.class_mode.back();
  }
}
