// What people read in the column above the panels: the world, what its organisms try to do, the marks, taking part.
import type {Membership} from "../core/protocol";

export const column_texts = {
  name: "Controls and panels",
  panels: "Panels",
  overview: "Overview",
  key: (number: number) => `Key ${number}`,
  world: "World",
  island: "Island",
  island_named: (island: number) => `island ${island}`,
  damaged: (world: string) => `${world} (damaged)`,
  no_world: "none",
  is_damaged: "This world is damaged and does not run.",
  loading: "Loading the experiment …",
  none_open: "No world is open yet.",
  healthiest: "Healthiest (♥ health):",
  zoom_in: "Zoom in to see which organisms are the healthiest.",
  none_alive: "No organism is alive.",
  organism: (id: number, health: number) => `#${id} ♥${Math.ceil(health)}`,
  organism_name: (id: number, health: number) => `Organism ${id}, health ${Math.ceil(health)}`,
  take_part: "Take part",
  only_watch: "Only watch",
  no_connection: "There is no connection.",
  is_member: ({name = "", class: of_class = "", teacher = ""}: Membership) =>
    `You are ${name} in ${of_class}${teacher && `, teacher ${teacher}`}.`,
  is_viewer: "You are a viewer: read-only.",
  takes_part: "You take part: changes act for everyone.",
  watches: (has_bodies: boolean) => `to run${has_bodies ? ", feed" : ""} and change this world.`,
  session: "The user and the role of this session",
};

/** The marks of the island. */
export const legend_texts = {
  vivid: (full: number) => `organism, ring: health (full: ${full})`,
  classic: () => "organism, number: health",
  predator: "predator",
  food: "food",
  poison: "poison",
  trail: "trail",
};
