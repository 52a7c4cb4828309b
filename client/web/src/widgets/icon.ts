// icon: the icon of the page: an organism with its arc of health, drawn here so that it needs no file.
import {h} from "./dom";

const side = 64;

export function show_icon(): void {
  const canvas = h("canvas", {width: side, height: side}), context = canvas.getContext("2d");
  if (!context) {
    return;
  }
  const middle = side / 2, quarter = Math.PI / 2;
  context.fillStyle = "#141628";
  context.beginPath();
  context.arc(middle, middle, middle, 0, 4 * quarter);
  context.fill();
  context.fillStyle = "#a08afa";
  context.beginPath();
  context.arc(middle, middle, 14, 0, 4 * quarter);
  context.fill();
  context.strokeStyle = "#ffffff";
  context.lineWidth = 6;
  context.beginPath();
  context.arc(middle, middle, 22, -quarter, 2 * quarter);
  context.stroke();
  // At once, before the browser asks for /favicon.ico: toBlob() would be too late.
  const png = Uint8Array.from(atob(canvas.toDataURL().split(",")[1] ?? ""), (letter) => letter.charCodeAt(0));
  document.head.append(h("link", {rel: "icon", href: URL.createObjectURL(new Blob([png], {type: "image/png"}))}));
}
