// qr: draws the QR codes that the server makes.
import type {QrCode} from "../core/protocol";
import {svg} from "../widgets/dom";

const quiet = 4; // modules around the code

/** The path of the dark modules, one horizontal run after the other. */
export function path_of({size = 0, modules = new Uint8Array()}: QrCode): string {
  let path = "";
  for (let y = 0; y < size; ++y) {
    for (let x = 0; x < size;) {
      let end = x;
      while (end < size && modules[y * size + end] === 1) {
        ++end;
      }
      path += end > x ? `M${x} ${y}h${end - x}v1h${x - end}z` : "";
      x = Math.max(end, x + 1);
    }
  }
  return path;
}

/** name: for screen readers */
export function qr_image(code: QrCode, name: string): SVGElement {
  const side = (code.size ?? 0) + 2 * quiet;
  return svg(
    "svg", {
      class: "qr",
      viewBox: `${- quiet} ${- quiet} ${side} ${side}`,
      role: "img",
      "aria-label": name,
      "shape-rendering": "crispEdges"
    },
    svg("rect", {x: -quiet, y: -quiet, width: side, height: side, fill: "#ffffff"}),
    svg("path", {d: path_of(code), fill: "#000000"}));
}
