// Panel: one tab of the docked column. Each panel builds its elements once and updates them in refresh().
import type {Server} from "./server";
import type {ViewedWorld} from "./world";

/** An organism that a tool places: its genes, and its name: "a copy of organism 12". */
export interface PlacedModel {
  name: string;
  genes: number[];
  gene_names?: string[]; // absent: those of the world from which it comes
}

export interface PanelContext {
  readonly server: Server;
  /** The world of the pane with the focus. */
  world(): ViewedWorld;
  /** The world of the other pane if two are shown side by side. */
  other(): ViewedWorld|null;
  /** Shows a second world next to the first, and focuses it. */
  show_beside(world: string, island?: number): void;
  /** Creates a world that starts from the shown moment, and shows it next to its origin. */
  fork(name?: string): Promise<void>;
  /** Opens a panel by its name, with a subject: open("glass box", {generation: 3, organism: 7}). */
  open(panel: string, subject?: {[key: string]: unknown}): void;
  /** Shows the wall of a class. */
  open_class(name: string): void;
  /** Lets each click in the focused island place a copy of the model. Returns whether it still does, as a
   *  function; null if it cannot, and a message says why. */
  place_by_clicks(model: PlacedModel): (() => boolean)|null;
  /** Shows a short message at the bottom, read by screen readers. It disappears after some seconds, and when `holds`
   *  returns false: what it states is not true any more. action: a button of the message. stays: it is a refusal,
   *  which stays until the next action. */
  notify(text: string, holds?: () => boolean, action?: {label: string; act: () => void}, stays?: boolean): void;
  /** Loads the page again, which then shows the same world, or the same moment of a replay. */
  reload(): void;
  /** Runs a request, and shows the sentence of a refusal. Returns whether it succeeded. */
  attempt(what: () => Promise<unknown>): Promise<boolean>;
}

export interface Panel {
  readonly name: string; // "parameters": stable, for links and tests
  readonly title: string; // the tab
  readonly element: HTMLElement;
  /** Called after each change while the panel is visible, and when it becomes visible. */
  refresh(): void;
  /** Called by PanelContext.open(). */
  show?(subject: {[key: string]: unknown}): void;
}
