// Wheel layout: the slots of a selection wheel as arcs to draw. Neighbouring slots that are too narrow are merged. No
// DOM.
import type {Contender} from "../core/protocol";
import {type Colour, ramp_at} from "../render/look";
import {rank_of} from "./record";

export interface Arc {
  begin: number; // in turns from the top, clockwise, 0 to 1
  end: number;
  first: number; // ids of the first and the last organism
  last: number;
  rank: number; // of the organism; for several, the mean weighted by the widths of their slots
}

/** Returns the arcs in the order of the slots, without slots of width 0.
 *
 *  turns_min  neighbouring slots narrower than this are merged into arcs that are at least this wide */
export function wheel_arcs(contenders: readonly Contender[], turns_min: number): Arc[] {
  const arcs: Arc[] = [];
  let open = false; // the last arc is still too narrow
  contenders.forEach((contender, organism) => {
    const begin = contender.slot_begin ?? 0, end = contender.slot_end ?? 0, width = end - begin;
    if (width <= 0) {
      return;
    }
    const last = arcs[arcs.length - 1];
    if (open && last && width < turns_min) {
      const before = last.end - last.begin;
      last.rank = (last.rank * before + rank_of(contender) * width) / (before + width);
      last.end = end;
      last.last = organism;
    } else {
      arcs.push({begin, end, first: organism, last: organism, rank: rank_of(contender)});
    }
    const newest = arcs[arcs.length - 1]!;
    open = width < turns_min && newest.end - newest.begin < turns_min;
  });
  return arcs;
}

/** The point of a circle at an angle in turns from the top, clockwise. */
export function point_at(centre: number, radius: number, turns: number): {x: number; y: number} {
  const angle = (turns - 0.25) * 2 * Math.PI;
  return {x: centre + radius * Math.cos(angle), y: centre + radius * Math.sin(angle)};
}

/** The outline of a part of a ring as an SVG path. */
export function ring_path(centre: number, inner: number, outer: number, begin: number, end: number): string {
  const stop = Math.min(end, begin + 0.99999); // an arc of a full turn would have no length
  const large = stop - begin > 0.5 ? 1 : 0;
  const at = (radius: number, turns: number): string => {
    const {x, y} = point_at(centre, radius, turns);
    return `${x.toFixed(2)} ${y.toFixed(2)}`;
  };
  return `M${at(outer, begin)}A${outer} ${outer} 0 ${large} 1 ${at(outer, stop)}L${at(inner, stop)}A${inner} ` +
    `${inner} 0 ${large} 0 ${at(inner, begin)}Z`;
}

/** Returns the colour of a rank: light for the fittest, dark for the lowest rank. Lightness alone encodes the rank, so
 *  it is visible with every kind of colour vision. */
export function rank_colour(rank: number, contender_count: number): Colour {
  return ramp_at("cividis", contender_count < 2 ? 1 : 1 - rank / (contender_count - 1));
}

/** Black or white, whichever is easier to read on this colour. */
export function text_on(colour: Colour): string {
  const linear = (part: number): number =>
    part / 255 <= 0.04045 ? part / 255 / 12.92 : ((part / 255 + 0.055) / 1.055) ** 2.4;
  return 0.2126 * linear(colour[0]) + 0.7152 * linear(colour[1]) + 0.0722 * linear(colour[2]) > 0.179 ? "#000" : "#fff";
}
