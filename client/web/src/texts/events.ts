// Texts of the panel "Events".
import {with_separators} from "./numbers";

export const events_texts = {
  title: "Events",
  list: "Events, newest first",
  none_yet: "Nothing has happened since this page was opened.",
  none_of_kind: "No event is of this kind.",
  this_world: "this world only",
  progress: "generations and migrations",
  show_events: "Show the events",
  show_commands: "Show all commands of the run",
  not_stored: "The server does not store this run.",
  commands_of: (world: string) => `Commands of ${world}, newest first`,
  no_command: "The run has received no command.",
  command_place: (tick: number, client: string) => `tick ${with_separators(tick)} · ${client || "a local client"}`,
  /** tick: 0 if the event has none */
  event_place:
    (time: string, world: string,
     tick: number) => [time, world, tick ? `tick ${with_separators(tick)}` : ""].filter(Boolean).join(" · "),
};
