// JoinForm: asks for the code of a class and a name, or for a personal code, and says why the server has refused them.
import type {ConnectionState} from "../core/messages";
import type {Join} from "../core/protocol";
import {join_texts as texts, join_refusals} from "../texts/join";
import {set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";

import {is_personal, letters_of} from "./codes";
import {class_style} from "./style";

const name_characters_max = 24;
/** Refusals about the name; all others are about the code. */
const of_name: ReadonlySet<string> = new Set(["REASON_MEMBER_NAME_TAKEN", "REASON_FIELD_INVALID"]);

export class JoinForm {
  readonly element: HTMLFormElement;
  readonly #code = h("input", {
    class: "field join-code",
    id: "join-code",
    autocomplete: "off",
    autocapitalize: "characters",
    spellcheck: "false",
    maxlength: 20,
    oninput: () => this.#refresh()
  });
  readonly #name =
    h("input",
      {class: "field", id: "join-name", autocomplete: "off", spellcheck: "false", maxlength: name_characters_max});
  readonly #name_part: HTMLElement;
  readonly #problem = h("p", {class: "error", role: "alert"});

  /** join: connects as a member of a class. */
  constructor(join: (join: Join) => void) {
    void class_style();
    this.#name_part = h("div", {class: "join-part"}, h("label", {for: "join-name"
                        }, texts.name), this.#name, h("p", {class: "hint"}, texts.name_help));
    const submit = (event: Event): void => {
      event.preventDefault();
      const code = letters_of(this.#code.value);
      if (code === "") {
        this.#say(texts.no_code, this.#code);
        return;
      }
      this.#say("", null);
      join({code, name: is_personal(code) ? "" : this.#name.value.trim()});
    };
    this.element =
      h("form", {class: "join", "aria-label": texts.title, onsubmit: submit}, h("h2", {}, texts.title),
        h("div", {class: "join-part"},
          h("label",
            {for: "join-code"
            },
            texts.code),
          this.#code, h("p", {class: "hint"}, texts.code_help)),
        this.#name_part, this.#problem, h("button", {type: "submit", class: "button button-primary"}, texts.join));
  }

  /** code: of the link; empty: none. */
  begin(code: string): void {
    this.#code.value = letters_of(code);
    this.#say("", null);
    this.#refresh();
    if (is_personal(this.#code.value)) {
      this.element.requestSubmit();
    } else {
      (code === "" ? this.#code : this.#name).focus();
    }
  }

  /** What a refusal of the server means for a student; empty: it is not about classes. */
  sentence({reason}: ConnectionState): string {
    return join_refusals[reason] ?? "";
  }

  /** is_joining: the refusal answers this form. */
  take_refusal(state: ConnectionState, is_joining: boolean): void {
    this.#refresh();
    if (is_joining) {
      this.#say(this.sentence(state) || state.message, of_name.has(state.reason) ? this.#name : this.#code);
    }
  }

  #say(problem: string, wrong: HTMLInputElement|null): void {
    set_text(this.#problem, problem);
    for (const field of [this.#code, this.#name]) {
      set_attribute(field, "aria-invalid", field === wrong ? "true" : null);
    }
    wrong?.focus();
  }

  #refresh(): void {
    this.#name_part.hidden = is_personal(letters_of(this.#code.value));
  }
}
