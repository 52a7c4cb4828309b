// Members: the members of a class as a table: who is connected, and letting in, removing, renaming and new personal
// codes; and adding members from a list, with a sheet of links to print.
import type {ClassMember, PersonalCode} from "../core/protocol";
import {member_texts as texts} from "../texts/class";
import {h, set_text} from "../widgets/dom";
import {button, hint, Question, row} from "../widgets/form";

import type {ForAllContext} from "./for_all";
import {spaced} from "./codes";
import {print_sheet} from "./sheet";

export class Members {
  readonly element: HTMLElement;
  readonly #context: ForAllContext;
  readonly #rows = h("tbody", {});
  readonly #names = h("textarea", {class: "field", rows: 6, "aria-label": texts.names, spellcheck: "false"});
  readonly #codes = h("div", {class: "class-codes", role: "status"});
  readonly #rename: Question;
  readonly #new_name =
    h("input", {class: "field grow", maxlength: 24, "aria-label": texts.new_name, spellcheck: "false"});
  readonly #rename_text = h("p", {});
  #renamed: ClassMember = {};
  #opener: HTMLElement|null = null;
  #shown = ""; // the members in the table, as text

  constructor(context: ForAllContext) {
    this.#context = context;
    this.#rename = new Question({before: [this.#rename_text], field: this.#new_name}, texts.rename, () => {
      const {number} = this.#renamed;
      this.#rename.close();
      void this.#change({number, name: this.#new_name.value.trim()});
    }, () => this.#opener?.isConnected ? this.#opener : this.element);
    const add =
      h("form", {
        class: "class-add",
        "aria-label": texts.add_title,
        onsubmit: (event: Event) => {
          event.preventDefault();
          void this.#add();
        }
      },
        h("h3", {}, texts.add_title), hint(texts.add_help), this.#names,
        row(h("button", {type: "submit", class: "button"}, texts.add)));
    const head = h("thead", {}, h("tr", {}, ...texts.headings.map((text) => h("th", {scope: "col"}, text))));
    this.element = h(
      "div", {class: "class-members", tabindex: -1}, this.#rename.element, this.#codes,
      h("div", {class: "class-table"}, h("table", {class: "table", "aria-label": texts.table}, head, this.#rows)), add);
    this.refresh();
  }

  refresh(): void {
    const {members} = this.#context.model, shown = JSON.stringify(members);
    if (shown === this.#shown) {
      return;
    }
    this.#shown = shown;
    const focused = document.activeElement instanceof HTMLElement ? document.activeElement.dataset.act : undefined;
    this.#rows.replaceChildren(...members.map((member) => this.#row(member)));
    if (focused) {
      this.#rows.querySelector<HTMLElement>(`[data-act="${focused}"]`)?.focus();
    }
  }

  #row(member: ClassMember): HTMLElement {
    const {number = 0, name = "", world = "", sessions = 0, removed = false, joined = false} = member;
    const act = (label: string, kind: string, does: (opener: HTMLElement) => void): HTMLButtonElement => {
      const made: HTMLButtonElement = button(
        label, () => does(made),
        {class: "button", "data-act": `${kind} ${number}`, "aria-label": texts.act(label, name)});
      return made;
    };
    const state = removed ? texts.is_removed :
      sessions > 0        ? texts.is_connected :
      joined              ? texts.is_away :
                            texts.never_joined;
    return h(
      "tr", {"data-removed": removed}, h("th", {scope: "row"}, name), h("td", {class: "class-world"}, world),
      h("td",
        {"data-state": removed ? "removed" :
           sessions > 0        ? "connected" :
                                 "away"},
        state),
      h("td", {},
        h("div", {class: "class-acts"},
          removed ? act(texts.readmit, "removed", () => void this.#change({number, removed: false})) :
                    act(texts.remove, "removed", () => void this.#change({number, removed: true})),
          act(texts.rename, "rename", (opener) => this.#ask_name(member, opener)),
          removed ? null : act(texts.new_code, "code", () => void this.#change({number, new_personal_code: true})))));
  }

  #ask_name(member: ClassMember, opener: HTMLElement): void {
    this.#renamed = member;
    this.#opener = opener;
    set_text(this.#rename_text, texts.ask_name(member.name ?? ""));
    this.#new_name.value = member.name ?? "";
    this.#rename.open();
  }

  async #change(fields: {number?: number|undefined; removed?: boolean; name?: string; new_personal_code?: boolean}):
    Promise<void> {
    const {server, model, attempt} = this.#context, {number = 0, ...rest} = fields;
    await attempt(async () => {
      const {codes = []} = await server.request("change_member", {class: model.name, number, ...rest});
      this.#show_codes(codes.filter(({code}) => code));
      await model.refresh();
    });
  }

  async #add(): Promise<void> {
    const {server, model, attempt, notify} = this.#context;
    const names = this.#names.value.split("\n").map((line) => line.trim());
    while (names.length > 0 && names.at(-1) === "") {
      names.pop();
    }
    if (names.length === 0) {
      notify(texts.no_names);
      return;
    }
    await attempt(async () => {
      const {codes = []} = await server.request("add_members", {class: model.name, names});
      this.#names.value = "";
      this.#show_codes(codes);
      await model.refresh();
    });
  }

  /** Personal codes are shown only once. */
  #show_codes(codes: readonly PersonalCode[]): void {
    if (codes.length === 0) {
      return;
    }
    const print = button(
      texts.print,
      () => void this.#context.attempt(() => print_sheet(this.#context.server, this.#context.model.name, codes)),
      {class: "button button-primary"});
    this.#codes.replaceChildren(
      h("h3", {}, texts.codes_title), hint(texts.codes_help),
      h("ul", {},
        ...codes.map(({name = "", code = ""}) => h("li", {}, h("span", {}, name), h("code", {}, spaced(code))))),
      row(print, button(texts.hide_codes, () => this.#codes.replaceChildren())));
    print.focus();
  }
}
