// Texts of the panel "Events".
import type * as english from "../texts/events";

import {with_separators} from "./numbers";

export const events_texts: typeof english.events_texts = {
  title: "Ereignisse",
  list: "Ereignisse, das neueste zuerst",
  none_yet: "Seit dem Öffnen der Seite ist nichts geschehen.",
  none_of_kind: "Kein Ereignis ist von dieser Art.",
  this_world: "nur diese Welt",
  progress: "Generationen und Migrationen",
  show_events: "Ereignisse zeigen",
  show_commands: "Alle Befehle des Laufs zeigen",
  not_stored: "Der Server speichert diesen Lauf nicht.",
  commands_of: (world) => `Befehle an ${world}, der neueste zuerst`,
  no_command: "Der Lauf hat keinen Befehl erhalten.",
  command_place: (tick, client) => `Tick ${with_separators(tick)} · ${client || "ein Programm auf dem Server"}`,
  event_place:
    (time, world, tick) => [time, world, tick ? `Tick ${with_separators(tick)}` : ""].filter(Boolean).join(" · "),
};
