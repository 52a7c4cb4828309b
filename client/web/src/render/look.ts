// Look: the colours and styles of the island in each skin and background, and the colour scales. The same values as in
// evoview (client/viewer/drawing/palette.cpp, client/viewer/island/styles.cpp); a test compares them.
import type {Look} from "../core/messages";

/** Red, green, blue and alpha, 0 to 255. */
export type Colour = readonly[number, number, number, number];

function rgb(red: number, green: number, blue: number, alpha = 255): Colour {
  return [red, green, blue, alpha];
}

export function css(colour: Colour): string {
  const [red, green, blue, alpha] = colour;
  return alpha === 255 ? `rgb(${red}, ${green}, ${blue})` :
                         `rgba(${red}, ${green}, ${blue}, ${(alpha / 255).toFixed(3)})`;
}

export function with_alpha(colour: Colour, alpha: number): Colour {
  return [colour[0], colour[1], colour[2], Math.trunc(alpha)];
}

/** The colour as a 32-bit integer; red is the lowest byte. */
export function packed(colour: Colour): number {
  return colour[0] | (colour[1] << 8) | (colour[2] << 16) | (colour[3] << 24);
}

// ---- colours ---------------------------------------------------------------------------------------------------

/** Colours for categories. Source: Okabe & Ito 2002, "Color Universal Design", without black. */
export const kinds: readonly Colour[] = [
  rgb(230, 159, 0),
  rgb(86, 180, 233),
  rgb(0, 158, 115),
  rgb(240, 228, 66),
  rgb(0, 114, 178),
  rgb(213, 94, 0),
  rgb(204, 121, 167),
];

/** Colours of lineages, distinguishable with every kind of colour vision. */
export const lineages: readonly Colour[] = [
  kinds[0]!,
  kinds[1]!,
  rgb(60, 132, 90),
  kinds[3]!,
  kinds[4]!,
  rgb(140, 70, 255),
  rgb(160, 84, 136),
];

/** For organisms without a value, or in a lineage without a colour. */
export const unknown = rgb(140, 140, 144);
export const organism_outline = rgb(20, 20, 24);
const strip = rgb(230, 230, 232);

/** The colours of an island, each in the variants dark, light and classic. */
const colour_table = {
  outside: [rgb(11, 12, 22), strip, strip], // around the walls
  ground: [rgb(20, 22, 40), rgb(250, 250, 253), rgb(204, 204, 204)],
  wall: [rgb(74, 80, 116), rgb(92, 96, 124), rgb(0, 0, 0)],
  label: [rgb(232, 232, 244), rgb(28, 26, 44), rgb(20, 20, 24)], // numbers on the ground
  body_low: [rgb(92, 66, 190), rgb(186, 170, 240), rgb(104, 22, 148)], // an organism with no health
  body_high: [rgb(206, 192, 255), rgb(84, 48, 196), rgb(104, 22, 148)], // one with the greatest health
  body: [rgb(160, 138, 250), rgb(112, 84, 222), rgb(104, 22, 148)], // an organism whose health is unknown
  arc: [rgb(255, 255, 255), rgb(52, 22, 130), rgb(104, 22, 148)], // the health arc; classic: the circle of an organism
  predator_low: [rgb(116, 74, 10), rgb(232, 196, 140), rgb(140, 64, 0)],
  predator_high: [rgb(255, 190, 60), rgb(190, 104, 0), rgb(140, 64, 0)],
  predator_edge: [rgb(255, 236, 200), rgb(104, 56, 0), rgb(140, 64, 0)],
  pointed_at: [rgb(255, 255, 255), rgb(52, 22, 130), rgb(190, 60, 250)], // rings around organisms
  selected: [rgb(255, 214, 90), rgb(224, 130, 0), rgb(255, 255, 255)],
  food: [rgb(150, 236, 116), rgb(92, 192, 88), rgb(62, 176, 76)],
  poison: [rgb(240, 52, 44), rgb(186, 12, 28), rgb(196, 22, 36)],
  crate: [rgb(124, 92, 58), rgb(204, 168, 122), rgb(190, 148, 96)],
  crate_edge: [rgb(186, 146, 98), rgb(132, 98, 56), rgb(104, 74, 38)],
  obstacle: [rgb(84, 90, 112), rgb(150, 154, 168), rgb(92, 94, 100)],
  food_radius: [rgb(150, 236, 116, 200), rgb(62, 150, 60, 220), rgb(62, 176, 76, 220)],
  poison_radius: [rgb(240, 72, 64, 220), rgb(186, 12, 28, 220), rgb(140, 8, 24, 220)],
  trail: [rgb(150, 130, 245, 120), rgb(112, 84, 222, 80), rgb(70, 30, 100)],
  death: [rgb(255, 176, 90), rgb(224, 120, 20), rgb(104, 22, 148)],
  wanders: [rgb(196, 198, 212), rgb(90, 90, 96), rgb(90, 90, 96)], // the choice of an organism
  seeks: [kinds[1]!, kinds[4]!, kinds[4]!],
  flees: [rgb(255, 140, 50), kinds[5]!, kinds[5]!],
};

export type IslandColours = {
  readonly[name in keyof typeof colour_table]: Colour
};

function colours_in(column: number): IslandColours {
  const of_name = Object.entries(colour_table).map(([name, colours]) => [name, colours[column] as Colour]);
  return Object.fromEntries(of_name) as IslandColours; // the names are those of the table
}

export const island_colours = {
  dark: colours_in(0),
  light: colours_in(1),
  classic: colours_in(2)
};

/** The name of the look's colours and styles. The classic skin is always grey. */
function variant(look: Look): "dark"|"light"|"classic" {
  return look.skin === "classic" ? "classic" : look.background;
}

export function colours_of(look: Look): IslandColours {
  return island_colours[variant(look)];
}

// ---- styles ----------------------------------------------------------------------------------------------------

export type Form = "circle"|"rectangle"|"line"|"arrow"|"body"|"leaf"|"star"|"ripple"|"soft_line"|"triangle";

/** All sizes are in CSS pixels. */
export interface ShapeStyle {
  form: Form;
  fill: Colour;
  edge: Colour;
  fill_low: Colour; // of a body or triangle without health; its colour changes to `fill` with its health
  edge_pixels: number; // width of the edge, inside the outline; 0: none. Of a body: of the arc, at most
  half_pixels_min: number; // a smaller shape is drawn with this half size, so that it stays visible
  line_pixels: number; // thickness of lines and arrows
}

export interface Styles {
  organism: ShapeStyle; // without a colouring
  coloured: ShapeStyle; // with a colour of its own
  predator: ShapeStyle; // with and without a colouring
  organism_dot: ShapeStyle; // streamed without radius and health
  food_dot: ShapeStyle; // among organisms that are too small to see one by one
  poison_dot: ShapeStyle;
  pointed_at: ShapeStyle;
  selected: ShapeStyle;
  highlight_pixels: number; // from the outline of an organism to the two rings above
  heading: ShapeStyle;
  food: ShapeStyle;
  poison: ShapeStyle;
  crate: ShapeStyle;
  obstacle: ShapeStyle;
  food_radius: ShapeStyle;
  poison_radius: ShapeStyle;
  arrow: ShapeStyle;
  target: ShapeStyle;
  trail: ShapeStyle;
  shadow: ShapeStyle; // of the walls on the outside
  ripple: ShapeStyle; // a meal or a death
  heading_pixels: number; // from the outline of an organism to the end of its heading, at most
  label_zoom_min: number; // at a smaller zoom, only highlighted organisms have numbers
}

const transparent: Colour = [0, 0, 0, 0];
const opaque_black: Colour = [0, 0, 0, 255];

function style(form: Form, given: Partial<ShapeStyle>): ShapeStyle {
  return {
    form,
    fill: opaque_black,
    edge: opaque_black,
    fill_low: opaque_black,
    edge_pixels: 0,
    half_pixels_min: 0,
    line_pixels: 1.5,
    ...given
  };
}

function vivid(of: IslandColours, shadow: number): Styles {
  const organism =
    style("body", {fill: of.body_high, edge: of.arc, fill_low: of.body_low, edge_pixels: 3, half_pixels_min: 1.5});
  return {
    ...common(of),
    organism,
    coloured: organism,
    predator: style("triangle", {
      fill: of.predator_high,
      edge: of.predator_edge,
      fill_low: of.predator_low,
      edge_pixels: 1,
      half_pixels_min: 1.5
    }),
    organism_dot: style("circle", {fill: of.body, half_pixels_min: 1.1}),
    pointed_at: style("circle", {fill: transparent, edge: of.pointed_at, edge_pixels: 2, half_pixels_min: 5}),
    food: style("leaf", {fill: of.food, half_pixels_min: 0.75}),
    poison: style("star", {fill: of.poison, half_pixels_min: 0.75}),
    trail: style("soft_line", {fill: of.trail, line_pixels: 5}),
    shadow: style("soft_line", {fill: [0, 0, 0, shadow], line_pixels: 48}),
    highlight_pixels: 8,
    heading_pixels: 10,
    label_zoom_min: 1.4,
  };
}

function classic(of: IslandColours): Styles {
  const organism = style("circle", {fill: transparent, edge: of.body, edge_pixels: 2, half_pixels_min: 1.5});
  return {
    ...common(of),
    organism,
    coloured: style("circle", {edge: organism_outline, edge_pixels: 1, half_pixels_min: 1.5}),
    predator: style(
      "triangle",
      {fill: transparent, edge: of.predator_edge, fill_low: transparent, edge_pixels: 2, half_pixels_min: 1.5}),
    organism_dot: organism,
    pointed_at: style("circle", {fill: [255, 255, 255, 90], edge: of.pointed_at, edge_pixels: 3, half_pixels_min: 4}),
    food: style("circle", {fill: of.food, half_pixels_min: 1}),
    poison: style("circle", {fill: of.poison, half_pixels_min: 1}),
    trail: style("line", {fill: of.trail, line_pixels: 1.5}),
    shadow: style("soft_line", {fill: transparent}),
    highlight_pixels: 0,
    heading_pixels: 6,
    label_zoom_min: 0.45,
  };
}

/** The styles that both skins share. */
function common(of: IslandColours) {
  return {
    selected: style("circle", {fill: transparent, edge: of.selected, edge_pixels: 3, half_pixels_min: 6}),
    heading: style("line", {fill: of.label, line_pixels: 2}),
    crate: style("rectangle", {fill: of.crate, edge: of.crate_edge, edge_pixels: 2, half_pixels_min: 1}),
    obstacle: style("rectangle", {fill: of.obstacle, half_pixels_min: 1}),
    food_radius: style("circle", {fill: transparent, edge: of.food_radius, edge_pixels: 1}),
    poison_radius: style("circle", {fill: transparent, edge: of.poison_radius, edge_pixels: 1}),
    arrow: style("arrow", {line_pixels: 2}),
    target: style("line", {line_pixels: 1}),
    food_dot: style("circle", {fill: with_alpha(of.food, 140), half_pixels_min: 0.5}),
    poison_dot: style("circle", {fill: with_alpha(of.poison, 140), half_pixels_min: 0.5}),
    ripple: style("ripple", {}),
  };
}

const styles = {
  dark: vivid(island_colours.dark, 110),
  light: vivid(island_colours.light, 60),
  classic: classic(island_colours.classic)
};

export function styles_of(look: Look): Styles {
  return styles[variant(look)];
}

/** The look at first, and after the user has chosen a skin. The classic skin shows organisms, items and walls only. */
export function default_look(skin: Look["skin"], background: Look["background"], interpolate = true): Look {
  const is_vivid = skin === "vivid";
  return {
    skin,
    background,
    colour_by: "",
    palette: "violet",
    trails: is_vivid,
    flashes: is_vivid,
    perception: is_vivid ? "selected" : "none",
    forces: "none",
    interpolate,
    density: true,
    minimap: true,
  };
}

// ---- colour scales ---------------------------------------------------------------------------------------------

/** Colour ramps for numbers; lightness rises with the number. Source: viridis and cividis: every 15th of the 256
 *  colours of matplotlib. Viridis: S. van der Walt and N. Smith, 2015. Cividis: Nuñez, Anderton & Renslow 2018,
 *  doi:10.1371/journal.pone.0199239. */
export const ramps: {readonly[name in Look["palette"]]: readonly(readonly[number, number, number])[]} = {
  violet: [[70, 38, 150], [112, 84, 222], [160, 138, 250], [208, 194, 255]],
  viridis: [
    [68, 1, 84],
    [72, 23, 105],
    [71, 42, 122],
    [67, 61, 132],
    [61, 78, 138],
    [53, 94, 141],
    [46, 109, 142],
    [41, 123, 142],
    [35, 137, 142],
    [31, 151, 139],
    [33, 165, 133],
    [46, 179, 124],
    [70, 192, 111],
    [101, 203, 94],
    [137, 213, 72],
    [176, 221, 47],
    [216, 226, 25],
    [253, 231, 37],
  ],
  cividis: [
    [0, 34, 78],
    [0, 45, 104],
    [22, 55, 112],
    [46, 65, 109],
    [63, 76, 108],
    [78, 86, 108],
    [92, 97, 110],
    [105, 107, 113],
    [118, 118, 118],
    [131, 129, 121],
    [146, 140, 120],
    [160, 152, 117],
    [175, 164, 113],
    [191, 176, 107],
    [207, 189, 98],
    [223, 202, 87],
    [240, 216, 70],
    [254, 232, 56],
  ],
};

/** Returns the colour at `share` of the ramp, clamped to 0 to 1; `unknown` if it is not a number. */
export function ramp_at(palette: Look["palette"], share: number): Colour {
  if (Number.isNaN(share)) {
    return unknown;
  }
  const stops = ramps[palette];
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const before = Math.min(Math.trunc(place), stops.length - 2);
  const [from, to, beyond] = [stops[before]!, stops[before + 1]!, place - before];
  const between = (channel: 0|1|2) => Math.round(from[channel] + (to[channel] - from[channel]) * beyond);
  return [between(0), between(1), between(2), 255];
}

/** The colours of a scale from `low` to `high` as 256 packed colours; faster than ramp_at() for each organism. */
export class ScaleTable {
  static readonly #tables = new Map<Look["palette"], Int32Array>();
  readonly colours: Int32Array;

  constructor(palette: Look["palette"], readonly low: number, readonly high: number) {
    let colours = ScaleTable.#tables.get(palette);
    if (colours === undefined) {
      colours = Int32Array.from({length: 256}, (_, i) => packed(ramp_at(palette, i / 255)));
      ScaleTable.#tables.set(palette, colours);
    }
    this.colours = colours;
  }

  at(value: number): number {
    const share = this.high > this.low ? (value - this.low) / (this.high - this.low) : 0.5;
    return this.colours[Math.trunc(Math.min(Math.max(share, 0), 1) * 255 + 0.5)]!;
  }
}

/** The smallest of 1, 2, 5, 10, 20 … that is at least `least`. */
export function nice_step(least: number): number {
  if (!(least > 0)) {
    return 1;
  }
  const ten = 10 ** Math.floor(Math.log10(least) + 1e-9);
  for (const factor of [1, 2, 5]) {
    if (least <= factor * ten * (1 + 1e-9)) {
      return factor * ten;
    }
  }
  return 10 * ten;
}
