// EventsPanel: what happened on the server since the page was opened, and the journal of a run: who changed what, and
// when.
import {common_texts} from "../texts/common";
import {events_texts as texts} from "../texts/events";
import {language} from "../texts/language";
import {guarded_button, set_allowed} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {check, hint} from "../widgets/form";
import {event_text} from "../world/event_text";
import {read_export} from "../world/run_export";

import type {Event as ProtocolEvent} from "../core/protocol";
import type {Panel, PanelContext} from "../world/panel_context";

const rows_max = 500;
const time_of_day = (time_ms: number): string => new Date(time_ms).toLocaleTimeString(language.times);
const fields_characters_max = 300; // of a command in the journal

interface Row {
  time_ms: number;
  world: string;
  tick: number;
  text: string;
  progress: boolean; // of the simulation itself, not of a client
}

/** A row of the table `events` as JSON (ExportRun). */
interface JournalLine {
  tick: number;
  kind: string; // "set_parameters"
  client?: string;
  request?: {[kind: string]: {[field: string]: unknown}};
}

export class EventsPanel implements Panel {
  readonly name = "events";
  readonly title = texts.title;
  readonly element: HTMLElement;

  #rows: Row[] = [];
  #changed = true;
  #shown_world = "";
  #this_world = h("input", {type: "checkbox", onchange: () => this.#rebuild()});
  #progress = h("input", {type: "checkbox", onchange: () => this.#rebuild()});
  #list = h("ol", {class: "journal", "aria-label": texts.list});
  #empty = hint(texts.none_yet);

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
      h("div", {class: "row"}, check(this.#this_world, texts.this_world), check(this.#progress, texts.progress));
    this.element =
      h("div", {class: "panel panel-events"}, h("div", {class: "row"}, this.#read), this.#title, this.#choices,
        this.#empty, this.#list);
    context.server.events.listen((event) => this.#take(event));
  }

  refresh(): void {
    const info = this.#context.world().info;
    set_text(this.#read, this.#journal ? texts.show_events : texts.show_commands);
    set_allowed(
      this.#read,
      this.#journal                   ? "" :
        !info                         ? common_texts.no_world :
        !info.storage && !info.replay ? texts.not_stored :
                                        "");
    if (this.#journal) {
      return;
    }
    if (this.#changed || (this.#this_world.checked && this.#shown_world !== this.#context.world().name)) {
      this.#rebuild();
    }
  }

  #take(event: ProtocolEvent): void {
    const [text, progress] = event_text(event);
    if (text) {
      this.#rows.unshift(
        {time_ms: event.time_ms ?? Date.now(), world: event.world ?? "", tick: event.tick ?? 0, text, progress});
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
    const world = this.#context.world().shown, read: string[] = [];
    await read_export(
      this.#context.server, {world, table: "RUN_TABLE_EVENTS", format: "TEXT_FORMAT_JSON_LINES"},
      (part) => read.push(...part));
    const lines = read.slice(-rows_max).reverse().map((line): JournalLine => JSON.parse(line));
    this.#show_journal({
      world,
      rows: lines.map((line) => row_of(texts.command_place(line.tick, line.client ?? ""), command_text(line)))
    });
  }

  #show_journal(journal: {world: string; rows: HTMLElement[]}|null): void {
    this.#journal = journal;
    this.#choices.hidden = journal !== null;
    this.#title.hidden = journal === null;
    if (journal) {
      set_text(this.#title, texts.commands_of(journal.world));
      this.#empty.hidden = journal.rows.length > 0;
      set_text(this.#empty, texts.no_command);
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
    set_text(this.#empty, this.#rows.length > 0 ? texts.none_of_kind : texts.none_yet);
    this.#list.replaceChildren(...rows.map(
      (row) =>
        row_of(texts.event_place(time_of_day(row.time_ms), row.world, row.tick), row.text)));
  }
}

function row_of(when: string, text: string): HTMLElement {
  return h("li", {}, h("span", {class: "hint"}, when), h("span", {}, text));
}

/** "set_parameters: {…}": a command of the journal with its fields, except the world. */
function command_text({kind, request}: JournalLine): string {
  const {world: _world, ...fields} = request?.[kind] ?? {}, text = JSON.stringify(fields);
  const shown = text.length > fields_characters_max ? text.slice(0, fields_characters_max) + " …" : text;
  return kind + (text === "{}" ? "" : `: ${shown}`);
}
