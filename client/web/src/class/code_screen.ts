// CodeScreen: what a projector shows while students join: the code in large letters, the link, and its QR code.
import {code_texts as texts} from "../texts/class";
import {Dialog} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button} from "../widgets/form";

import type {ForAllContext} from "./for_all";
import {join_link, spaced} from "./codes";
import {qr_image} from "./qr";

const second_ms = 1000;

export class CodeScreen {
  readonly #context: ForAllContext;
  readonly #dialog = new Dialog(texts.title, "class-code");
  readonly #code = h("p", {class: "class-code-letters"});
  readonly #link = h("p", {class: "class-code-link"});
  readonly #qr = h("div", {class: "class-code-qr"});
  readonly #state = h("p", {class: "class-code-state", role: "status"});
  readonly #guessed = h("p", {class: "warning", role: "status"});
  readonly #lock: HTMLButtonElement;
  #shown = ""; // the code of the QR code
  readonly #timer: number;

  constructor(context: ForAllContext) {
    this.#context = context;
    this.#lock = button("", () => void this.#update({open: this.#code_now === ""}));
    const renew = button(texts.new_code, () => void this.#update({open: true, new_code: true}));
    const how =
      h("div", {class: "class-code-how"}, h("p", {}, texts.open), this.#link, h("p", {}, texts.type), this.#code);
    this.#dialog.body.append(
      h("div", {class: "class-code-main"}, this.#qr, how),
      h("div", {class: "row class-code-foot"}, this.#state, h("span", {class: "grow"}), this.#lock, renew),
      this.#guessed);
    this.#timer = setInterval(() => this.#dialog.is_open && this.refresh(), second_ms) as unknown as number;
  }

  open(): void {
    this.#dialog.open();
    this.refresh();
  }

  close(): void {
    clearInterval(this.#timer);
    this.#dialog.element.remove();
  }

  get #code_now(): string {
    const {model} = this.#context;
    return model.code_valid_s > 0 ? model.info?.code ?? "" : "";
  }

  refresh(): void {
    const {model} = this.#context, code = this.#code_now, {members} = model;
    set_text(this.#code, code === "" ? texts.none : spaced(code));
    set_text(this.#link, code === "" ? "" : join_link(location.origin + location.pathname, code));
    const joined = members.filter((member) => member.joined && !member.removed).length;
    set_text(this.#state, texts.state(joined, Math.ceil(model.code_valid_s / 60), code !== ""));
    set_text(this.#lock, code === "" ? texts.unlock : texts.lock);
    set_text(this.#guessed, model.info?.codes_are_guessed ? texts.guessed : "");
    if (code !== this.#shown) {
      this.#shown = code;
      this.#qr.replaceChildren();
      if (code !== "") {
        void this.#draw(code);
      }
    }
  }

  async #draw(code: string): Promise<void> {
    const link = join_link(location.origin + location.pathname, code);
    await this.#context.attempt(async () => {
      const {codes = []} = await this.#context.server.request("make_qr_codes", {texts: [link]});
      if (code === this.#shown && codes[0]) {
        this.#qr.replaceChildren(qr_image(codes[0], texts.qr(link)));
      }
    });
  }

  async #update(fields: {open?: boolean; new_code?: boolean}): Promise<void> {
    const {server, model, attempt} = this.#context;
    await attempt(async () => model.take(await server.request("update_class", {class: model.name, ...fields})));
    this.refresh();
  }
}
