// svg: the shapes of drawings.
import {svg} from "./dom";

type Attributes = Parameters<typeof svg>[1];
type Children = (Node|string)[];

/** box: x, y, width, height */
export function svg_rect(
  kind: string, [x, y, width, height]: readonly[number, number, number, number], attributes: Attributes = {},
  ...children: Children): SVGRectElement {
  return svg("rect", {class: kind, x, y, width, height, ...attributes}, ...children);
}

/** ends: x1, y1, x2, y2 */
export function svg_line(
  kind: string, [x1, y1, x2, y2]: readonly[number, number, number, number],
  attributes: Attributes = {}): SVGLineElement {
  return svg("line", {class: kind, x1, y1, x2, y2, ...attributes});
}

/** at: x, y; attributes: of a text that does not begin there: {"text-anchor": "end"} */
export function svg_label(
  kind: string, [x, y]: readonly[number, number], text: string, attributes: Attributes = {}): SVGTextElement {
  return svg("text", {class: kind, x, y, ...attributes}, text);
}
