// Texts of the panel "View".
import type {Look} from "../core/messages";

type Switch = "trails"|"flashes"|"density"|"minimap"|"interpolate";

export const view_texts = {
  language: "language (Sprache)",
  languages: {"": "automatic (automatisch)", en: "English", de: "Deutsch"},
  skin: "skin",
  skins: {vivid: "vivid", classic: "classic"} as {readonly[skin in Look["skin"]]: string},
  background: "background",
  backgrounds: {dark: "dark", light: "light"} as {readonly[background in Look["background"]]: string},
  colour_by: "colour by (C)",
  by_nothing: "nothing",
  by_nothing_vivid: "nothing (shade: health)",
  by_health: "health",
  by_lineage: "lineage (common ancestor)",
  by_gene: (gene: string) => `gene ${gene}`,
  palette: "palette",
  palettes: {violet: "violet", viridis: "viridis", cividis: "cividis"} as
    {readonly[palette in Look["palette"]]: string},
  lineages: "Lineages are counted from the first generation. After one of them has taken over, all organisms have " +
    "its colour.",
  perception: "perception radii (V)",
  forces: "forces (G)",
  of_which: {none: "none", selected: "at the mouse or selected", all: "all"} as
    {readonly[which in Look["perception"]]: string},
  switches: {
    trails: "trails of the last 3 simulated seconds (T)",
    flashes: "flashes of meals and deaths",
    density: "density map where organisms are too many",
    minimap: "minimap while zoomed in",
    interpolate: "smooth movement between snapshots",
  } as {readonly[name in Switch]: string},
  follow: "keep the selected organism centred (L)",
  select_first: "Click an organism to select it.",
};
