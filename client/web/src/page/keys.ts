// keys: the keys of the whole page, and the help that lists them. Keys of the canvas (pan, zoom) belong to Pane.
import type {RequestKind} from "../core/messages";
import {Dialog} from "../widgets/controls";
import {h} from "../widgets/dom";
import type {PanelContext} from "../world/panel_context";
import type {Server} from "../world/server";
import type {Column} from "./column";
import type {PaneArea} from "./pane_area";
import {toggle_replay} from "./run_bar";

/** What the keys act on. */
export interface KeyTarget extends PanelContext {
  readonly server: Server;
  readonly column: Column;
  area(): PaneArea;
  link(): string;
  toggle_beside(): void;
  focus_other(): void;
  toggle_column(): void;
  toggle_help(): void;
}

interface Binding {
  keys: string[]; // values of KeyboardEvent.key; letters in lower case
  shown?: string; // in the help, if it differs from keys
  help: string;
  act(app: KeyTarget, event: KeyboardEvent): unknown; // a promise's refusal is shown as a notice
}

const last_panel_key = 9;

const zoom_step = 1.25, pan_px = 48;
const arrows: {[key: string]: [number, number]} = {
  ArrowLeft: [-pan_px, 0],
  ArrowRight: [pan_px, 0],
  ArrowUp: [0, -pan_px],
  ArrowDown: [0, pan_px]
};

const bindings: Binding[] = [
  {
    keys: [" "],
    shown: "Space",
    help: "run, pause, resume",
    act: (app) => command(app, "pause", () => app.world().control.pause_or_resume())
  },
  {keys: ["."], help: "one tick, then pause", act: (app) => command(app, "pause", () => app.world().control.step(1))},
  {
    keys: [">", ":"],
    shown: "Shift+.",
    help: "60 ticks, then pause",
    act: (app) => command(app, "pause", () => app.world().control.step(60))
  },
  {
    keys: ["+", "="],
    shown: "+",
    help: "double the speed",
    act: (app) => command(app, "set_speed", () => app.world().control.multiply_speed(2))
  },
  {
    keys: ["-", "_"],
    shown: "−",
    help: "halve the speed",
    act: (app) => command(app, "set_speed", () => app.world().control.multiply_speed(0.5))
  },
  {
    keys: ["r"],
    help: "real time",
    act: (app) => command(app, "set_speed", () => app.world().control.set_speed({real_time_factor: 1}))
  },
  {
    keys: ["m"],
    help: "maximum speed; again: the previous speed",
    act: (app) => command(app, "set_speed", () => app.world().control.toggle_max_speed())
  },
  {keys: ["PageDown"], shown: "Page Down", help: "next island", act: (app) => move_island(app, 1)},
  {keys: ["PageUp"], shown: "Page Up", help: "previous island", act: (app) => move_island(app, -1)},
  {keys: ["w"], help: "next world", act: (app) => next_world(app)},
  {
    keys: ["p"],
    help: "replay the run of the world; again: the live world",
    act: (app) => toggle_replay(app, app.world())
  },
  {keys: ["["], help: "in a replay: the previous generation", act: (app) => move_generation(app, -1)},
  {keys: ["]"], help: "in a replay: the next generation", act: (app) => move_generation(app, 1)},
  {
    keys: ["b"],
    help: "show a second world, or the past of this one, too; again: only the focused world",
    act: (app) => app.toggle_beside()
  },
  {keys: ["x"], help: "move the focus to the other world", act: (app) => app.focus_other()},
  {keys: ["f", "Home"], shown: "F   Home", help: "show the whole island", act: (app) => app.area().pane.fit()},
  {
    keys: ["z"],
    shown: "Z   Shift+Z",
    help: "zoom in, zoom out",
    act: (app, event) => app.area().pane.zoom_by(event.shiftKey ? 1 / zoom_step : zoom_step)
  },
  {
    keys: Object.keys(arrows),
    shown: "←   →   ↑   ↓",
    help: "move the view",
    act: (app, event) => app.area().pane.pan_by(...arrows[event.key]!)
  },
  {
    keys: ["l"],
    help: "follow the selected organism; again: stop",
    act: (app) => app.world().selection.set_follow(!app.world().selection.follow)
  },
  {keys: ["c"], help: "colour by health, lineage, a gene, nothing", act: (app) => next_colouring(app)},
  {
    keys: ["v"],
    help: "perception radii: of the organism at the pointer, of all, of none",
    act: (app) => app.world().set_look({perception: next_of(app.world().look.perception)})
  },
  {
    keys: ["g"],
    help: "forces: of the organism at the pointer, of all, of none",
    act: (app) => app.world().set_look({forces: next_of(app.world().look.forces)})
  },
  {keys: ["t"], help: "show or hide trails", act: (app) => app.world().set_look({trails: !app.world().look.trails})},
  {keys: ["d"], help: "hide the column; again: show it", act: (app) => app.toggle_column()},
  {keys: ["?", "h", "F1"], shown: "?   H", help: "show or hide this help", act: (app) => app.toggle_help()},
  {keys: ["Escape"], shown: "Esc", help: "close the help, end a tool, select no organism", act: (app) => escape(app)},
];

const gestures: [string, string][] = [
  ["Ctrl+C", "copy a link to this moment"],
  ["Wheel   pinch", "zoom at the pointer"],
  ["Drag", "move the view"],
  ["Click   tap", "select an organism; on empty space: select none; or use the chosen tool"],
];

let by_pointer = false; // whether the focus was moved by a pointer last, not by a key

export function listen_to_keys(app: KeyTarget): void {
  document.addEventListener("pointerdown", () => {
    by_pointer = true;
  }, true);
  document.addEventListener("keydown", (event) => {
    by_pointer &&= event.key === " ";
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
      app.notify(`Copied ${link}`);
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

export class Help {
  #dialog: Dialog|null = null;

  readonly #app: KeyTarget;

  constructor(app: KeyTarget) {
    this.#app = app;
  }

  toggle(): void {
    if (this.#dialog?.is_open) {
      this.#dialog.close();
      return;
    }
    if (!this.#dialog) {
      this.#dialog = new Dialog("Keys and gestures", "help");
      const panels = this.#app.column.panels.slice(0, last_panel_key);
      const lines: [string, string][] = [
        ...bindings.map(
          ({keys, shown, help}): [string, string] => [shown ?? keys.map((key) => key.toUpperCase()).join("   "), help]),
        ...panels.map((panel, i): [string, string] => [String(i + 1), `show the panel ${panel.title}`]),
        ...gestures,
      ];
      this.#dialog.body.append(
        h("dl", {class: "keys"},
          ...lines.map(
            ([keys, help]) =>
              h("div", {}, h("dt", {}, ...keys.split("   ").map((key) => h("kbd", {}, key))), h("dd", {}, help)))));
    }
    this.#dialog.open();
  }
}

/** Runs a command, or shows why the user may not. */
async function command(app: KeyTarget, kind: RequestKind, act: () => Promise<void>): Promise<void> {
  const world = app.world(), why = app.server.why_not(kind, world.shown);
  if (!world.shown) {
    return;
  }
  if (why) {
    app.notify(why);
  } else if (world.control.is_over && kind !== "set_speed") {
    app.notify(
      world.is_replay ? "This is the end of the replay; [ goes back by a generation." :
                        "The run has ended; resetting the world starts it again.");
  } else {
    await act();
  }
}

function move_island(app: KeyTarget, by: number): void {
  const world = app.world(), count: number = world.info?.island_count ?? 1;
  world.choose_island((world.island + by + count) % count);
}

function next_world(app: KeyTarget): void {
  const names = app.server.world_names;
  if (names.length > 0) {
    app.world().show(names[(names.indexOf(app.world().name) + 1) % names.length]!);
  }
}

async function move_generation(app: KeyTarget, by: number): Promise<void> {
  const world = app.world();
  if (!world.is_replay) {
    app.notify("The world is live; P replays its run.");
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
  app.notify(next ? `Colour: ${next}` : "Colour: none");
}

function escape(app: KeyTarget): void {
  const pane = app.area().pane;
  if (pane.tool !== "select") {
    pane.set_tool("select");
  } else {
    app.world().selection.select(null);
  }
}
