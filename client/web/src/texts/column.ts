// What people read in the column above the panels: the world, what its organisms try to do, the marks, taking part.

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
  hide_description: "Hide the description",
  show_description: "Show the description",
  healthiest: "Healthiest now:",
  zoom_in: "Zoom in to see which organisms are the healthiest.",
  none_alive: "No organism is alive.",
  organism: (id: number, health: number) => `#${id} (${Math.ceil(health)})`,
  take_part: "Take part",
  no_connection: "There is no connection.",
  is_viewer: "You are a viewer: read-only.",
  takes_part: "Changes act for everyone.",
  watches: "You only watch.",
  session: "The user and the role of this session",
};

/** The marks of the island. */
export const legend_texts = {
  vivid: "organism, arc: health",
  classic: "organism, number: health",
  food: "food",
  poison: "poison",
};
