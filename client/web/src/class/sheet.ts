// sheet: prints the personal codes of members: a slip with name, code and QR code for each.
import type {PersonalCode, QrCode} from "../core/protocol";
import {sheet_texts as texts} from "../texts/class";
import {h} from "../widgets/dom";
import type {Server} from "../world/server";

import {join_link, spaced} from "./codes";
import {qr_image} from "./qr";

const codes_at_once = 50; // QR codes in one answer

/** Makes the sheet and opens the browser's dialog for printing. */
export async function print_sheet(server: Server, of_class: string, members: readonly PersonalCode[]): Promise<void> {
  const page = location.origin + location.pathname, links = members.map(({code = ""}) => join_link(page, code));
  const codes: QrCode[] = [];
  for (let i = 0; i < links.length; i += codes_at_once) {
    codes.push(...(await server.request("make_qr_codes", {texts: links.slice(i, i + codes_at_once)})).codes ?? []);
  }
  const slips = members.map(
    ({name = "", code = ""}, i) => h(
      "div", {class: "class-slip"}, codes[i] ? qr_image(codes[i]!, texts.qr(name)) : null,
      h("div", {}, h("strong", {}, name), h("span", {}, of_class), h("code", {}, spaced(code)), h("small", {}, page))));
  const sheet = h("div", {class: "class-sheet"}, h("p", {}, texts.help), h("div", {class: "class-slips"}, ...slips));
  document.body.append(sheet);
  addEventListener("afterprint", () => sheet.remove(), {once: true});
  print();
}
