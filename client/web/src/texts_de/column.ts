// What people read in the column above the panels: the world, what its organisms try to do, the marks, taking part.
import type * as english from "../texts/column";

export const column_texts: typeof english.column_texts = {
  name: "Bedienung und Bereiche",
  panels: "Bereiche",
  overview: "Übersicht",
  key: (number) => `Taste ${number}`,
  world: "Welt",
  island: "Insel",
  island_named: (island) => `Insel ${island}`,
  damaged: (world) => `${world} (beschädigt)`,
  no_world: "keine",
  is_damaged: "Diese Welt ist beschädigt und läuft nicht.",
  loading: "Experiment wird geladen …",
  none_open: "Noch ist keine Welt offen.",
  healthiest: "Am gesündesten (♥ Gesundheit):",
  zoom_in: "Hineinzoomen zeigt, welche Organismen am gesündesten sind.",
  none_alive: "Kein Organismus lebt.",
  organism: (id, health) => `#${id} ♥${Math.ceil(health)}`,
  organism_name: (id, health) => `Organismus ${id}, Gesundheit ${Math.ceil(health)}`,
  take_part: "Mitmachen",
  only_watch: "Nur zusehen",
  no_connection: "Es besteht keine Verbindung.",
  is_member: ({name = "", class: of_class = "", teacher = ""}) =>
    `Du bist ${name} in ${of_class}${teacher && `, Lehrkraft ${teacher}`}.`,
  is_viewer: "Zuschauer: ohne Änderungen.",
  takes_part: "Mitmachen ist an: Änderungen wirken für alle.",
  watches: (has_bodies) => `zum Starten${has_bodies ? ", Füttern" : ""} und Ändern dieser Welt.`,
  session: "Name und Rolle dieser Sitzung",
};

export const legend_texts: typeof english.legend_texts = {
  vivid: (full) => `Organismus, Ring: Gesundheit (voll: ${full})`,
  classic: () => "Organismus, Zahl: Gesundheit",
  predator: "Räuber",
  food: "Futter",
  poison: "Gift",
  trail: "Spur",
};
