// What people read around the worlds: the title, buttons of the column, banners, notices, links.
import type * as english from "../texts/app";

export const app_texts: typeof english.app_texts = {
  title: (world) => world === "" ? "evod" : `${world} – evod`,
  about: (has_items, births) => "Evolution, live: " +
    (births      ? "Organismen suchen Futter und meiden Gift; gesunde bekommen Kinder." :
       has_items ? "Organismen suchen Futter und meiden Gift; die fittesten haben mehr Kinder." :
                   "Die fittesten Organismen jeder Generation haben mehr Kinder."),
  no_world: "Der Server hat noch keine Welt.",
  new_world: "Neue Welt …",
  skip: "Zur Welt springen",
  hide_column: "Spalte verbergen",
  hide_column_help: "Spalte verbergen (D)",
  show_column: "Spalte zeigen",
  show_column_help: "Spalte zeigen (D)",
  help: "Tasten und Gesten",
  help_help: "Tasten und Gesten (?)",
  forked: (world) => `Welt ${world} aus diesem Moment abgezweigt`,
  link: "Link zu diesem Moment",
  copied: (link) => `${link} kopiert`,
  close: "Schließen",
  lost: (message) => `${message || "Verbindung wird aufgebaut"}. Neuer Versuch …`,
  has_shut_down: "Der Server wurde beendet. Neuer Versuch …",
  shuts_down: "Der Server wird gleich beendet.",
  updated: "Der Server wurde erneuert: Bitte die Seite neu laden.",
  reload: "Neu laden",
  frozen: "Deine Lehrkraft hat die Klasse angehalten. Alles geht weiter, sobald sie es erlaubt.",
  other_class: "Der Link führt in eine Klasse.",
  join_class: "Als neues Mitglied beitreten",
  stay: "Bleiben",
  student_world: (name, of_class) => `Du siehst die Welt von ${name} (${of_class}).`,
  back_to_class: "Zurück zur Klasse",
  other_token: (session) => `Der Link enthält ein anderes Token. Verbunden als ${session}.`,
  use_token: "Token des Links nehmen",
  keep_token: "Meines behalten",
};
