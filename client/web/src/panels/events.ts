// EventsPanel: what happened on the server since the page was opened, and the journal of a run: who changed what, and when.
import {with_separators} from "../texts/numbers";
import {guarded_button, set_allowed} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {event_text} from "../world/event_text";

import type {Message} from "../core/messages";
import type {Panel, PanelContext} from "../world/panel_context";

const rows_max = 500;
const fields_characters_max = 300; // of a command in the journal

interface Row {
  time_ms: number;
  world: string;
  tick: number;
  text: string;
  progress: boolean; // of the simulation itself, not of a client
}

export class EventsPanel implements Panel {
  readonly name = "events";
  readonly title = "Events";
  readonly element: HTMLElement;

  #rows: Row[] = [];
  #changed = true;
  #shown_world = "";
  #this_world = h("input", {type: "checkbox", onchange: () => this.#rebuild()});
  #progress = h("input", {type: "checkbox", onchange: () => this.#rebuild()});
  #list = h("ol", {class: "journal", "aria-label": "Events, newest first"});
  #empty = h("p", {class: "hint"}, "Nothing has happened since this page was opened.");

  #journal: {world: string; rows: HTMLElement[]}|null = null; // shown instead of the events
  #read: HTMLButtonElement;
  #choices: HTMLElement;
  #title = h("h3", {hidden: true});

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    this.#read = guarded_button(
      "", context.notify,
      () => (this.#journal ? this.#show_journal(null) : void context.attempt(() => this.#read_journal())));
    this.#choices =
      h("div", {class: "row"}, h("label", {class: "check"}, this.#this_world, "this world only"),
        h("label", {class: "check"}, this.#progress, "generations and migrations"));
    this.element =
      h("div", {class: "panel panel-events"}, h("div", {class: "row"}, this.#read), this.#title, this.#choices,
        this.#empty, this.#list);
    context.server.on_event((event) => this.#take(event));
  }

  refresh(): void {
    const info = this.#context.world().info;
    set_text(this.#read, this.#journal ? "Show the events" : "Show all commands of the run");
    set_allowed(
      this.#read,
      this.#journal                   ? "" :
        !info                         ? "No world is open." :
        !info.storage && !info.replay ? "The server does not store this run." :
                                        "");
    if (this.#journal) {
      return;
    }
    if (this.#changed || (this.#this_world.checked && this.#shown_world !== this.#context.world().name)) {
      this.#rebuild();
    }
  }

  #take(event: Message): void {
    const [text, progress] = event_text(event);
    if (text) {
      this.#rows.unshift({
        time_ms: Number(event.time_ms ?? Date.now()),
        world: event.world ?? "",
        tick: Number(event.tick ?? 0),
        text,
        progress
      });
      this.#trim(true);
      this.#trim(false);
      this.#changed = true;
    }
  }

  /** Events about progress are many; they never push out those about clients. */
  #trim(progress: boolean): void {
    if (this.#rows.filter((row) => row.progress === progress).length > rows_max) {
      this.#rows.splice(this.#rows.map((row) => row.progress).lastIndexOf(progress), 1);
    }
  }

  /** Reads the journal of the shown run: one line of JSON for each command. */
  async #read_journal(): Promise<void> {
    const {server} = this.#context, world = this.#context.world().shown, decoder = new TextDecoder();
    let part = await server.request("export_run", {world, table: "RUN_TABLE_EVENTS", format: "TEXT_FORMAT_JSON_LINES"});
    let text = decoder.decode(part.text ?? new Uint8Array(), {stream: true});
    while (!part.last) {
      part = await server.request("continue_export", {export_id: part.export_id});
      text += decoder.decode(part.text ?? new Uint8Array(), {stream: true});
    }
    const lines =
      text.split("\n").filter(Boolean).map((line): Message => JSON.parse(line)).reverse().slice(0, rows_max);
    this.#show_journal({
      world,
      rows: lines.map(
        (line) => row_of(`tick ${with_separators(line.tick)} · ${line.client || "a local client"}`, command_text(line)))
    });
  }

  #show_journal(journal: {world: string; rows: HTMLElement[]}|null): void {
    this.#journal = journal;
    this.#choices.hidden = journal !== null;
    this.#title.hidden = journal === null;
    if (journal) {
      set_text(this.#title, `Commands of ${journal.world}, newest first`);
      this.#empty.hidden = journal.rows.length > 0;
      set_text(this.#empty, "The run has received no command.");
      this.#list.replaceChildren(...journal.rows);
    } else {
      this.#rebuild();
    }
    this.refresh();
  }

  #rebuild(): void {
    this.#changed = false;
    this.#shown_world = this.#context.world().name;
    const rows = this.#rows
                   .filter(
                     (row) => (this.#progress.checked || !row.progress) &&
                       (!this.#this_world.checked || row.world === "" || row.world === this.#shown_world))
                   .slice(0, rows_max);
    this.#empty.hidden = rows.length > 0;
    set_text(
      this.#empty,
      this.#rows.length > 0 ? "No event is of this kind." : "Nothing has happened since this page was opened.");
    this.#list.replaceChildren(...rows.map(
      (row) => row_of(
        `${new Date(row.time_ms).toLocaleTimeString("en-GB")}${row.world ? ` · ${row.world}` : ""}${
          row.tick ? ` · tick ${with_separators(row.tick)}` : ""}`,
        row.text)));
  }
}

function row_of(when: string, text: string): HTMLElement {
  return h("li", {}, h("span", {class: "hint"}, when), h("span", {}, text));
}

/** "set_parameters: {…}": a command of the journal with its fields, except the world. */
function command_text(line: Message): string {
  const {world: _world, ...fields}: Message = line.request?.[line.kind] ?? {}, text = JSON.stringify(fields);
  return line.kind +
    (text === "{}" ? "" :
                     `: ${text.length > fields_characters_max ? text.slice(0, fields_characters_max) + " …" : text}`);
}
