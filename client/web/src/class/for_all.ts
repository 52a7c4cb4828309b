// ForAll: what the teacher does with all worlds of a class at once: freeze, speed, run, parameters, reset.
import type {ForEachWorld, Speed} from "../core/protocol";
import {for_all_texts as texts} from "../texts/class";
import {speed_text} from "../texts/states";
import {set_allowed, set_attribute, set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button, Question, row} from "../widgets/form";
import type {Notify} from "../widgets/notices";
import {grouped, is_number, label_of, label_of_choice} from "../world/parameters";
import {typed_number, value_of} from "../world/parameter_values";
import type {Server} from "../world/server";

import type {ClassModel} from "./class_model";

const narrow = "(max-width: 900px)"; // as in class.css
const speeds = ["0.25", "0.5", "1", "2", "5", "10", "20", "max"];

export interface ForAllContext {
  readonly server: Server;
  readonly model: ClassModel;
  notify: Notify;
  attempt(what: () => Promise<unknown>): Promise<boolean>;
}

export class ForAll {
  readonly element: HTMLElement;
  readonly freeze: HTMLButtonElement;
  readonly #context: ForAllContext;
  readonly #speed = h("select", {class: "field", "aria-label": texts.speed, onchange: () => this.#set_speed()});
  readonly #generations =
    h("input", {class: "field wall-number", inputmode: "numeric", value: "10", "aria-label": texts.generations});
  readonly #parameter =
    h("select", {class: "field grow", "aria-label": texts.parameter, onchange: () => this.#show_value()});
  readonly #value = h("span", {class: "wall-value"});
  readonly #reset: HTMLButtonElement;
  readonly #confirm: Question;

  constructor(context: ForAllContext) {
    this.#context = context;
    this.freeze = button("", () => void this.toggle_freeze(), {class: "button wall-freeze"});
    this.#reset = button(texts.reset, () => this.#confirm.open());
    this.#confirm = new Question({before: [h("p", {}, texts.ask_reset)]}, texts.do_reset, () => {
      this.#confirm.close();
      void this.#send({reset_world: {}}, texts.reset_done);
    }, () => this.#reset);
    const set =
      h("form", {
        class: "row wall-set",
        "aria-label": texts.set,
        onsubmit: (event: Event) => {
          event.preventDefault();
          this.#set_parameter();
        }
      },
        this.#parameter, this.#value, h("button", {type: "submit", class: "button"}, texts.set));
    const controls =
      h("div", {},
        row(
          button(texts.run, () => void this.#send({run: {}}, texts.run_done)),
          button(texts.pause, () => void this.#send({pause: {}}, texts.pause_done)), this.#speed),
        h("form", {
          class: "row",
          "aria-label": texts.run_generations,
          onsubmit: (event: Event) => {
            event.preventDefault();
            this.#run_generations();
          }
        },
          this.#generations, h("button", {type: "submit", class: "button"}, texts.run_generations)),
        set, this.#reset, this.#confirm.element);
    const is_narrow = matchMedia(narrow).matches;
    this.element = h("details", {class: "wall-for-all", open: !is_narrow}, h("summary", {}, texts.title), controls);
    set_options(
      this.#speed,
      [{value: "", text: texts.speed}, ...speeds.map((speed) => ({value: speed, text: speed_text(speed_of(speed))}))],
      "");
    this.#list_parameters();
    this.refresh();
  }

  refresh(): void {
    const {is_frozen} = this.#context.model;
    set_text(this.freeze, is_frozen ? texts.go_on : texts.freeze);
    set_attribute(this.freeze, "aria-pressed", String(is_frozen));
    set_allowed(this.freeze, "", texts.freeze_help);
    this.#list_parameters();
  }

  /** Stops all worlds of the class at once, or lets them go on. */
  async toggle_freeze(): Promise<void> {
    const {model, server, attempt} = this.#context, frozen = !model.is_frozen;
    await attempt(async () => {
      model.take(await server.request("update_class", {class: model.name, frozen}));
    });
  }

  #list_parameters(): void {
    const {parameters} = this.#context.server;
    if (this.#parameter.options.length > 0 || parameters.length === 0) {
      return;
    }
    this.#parameter.replaceChildren(
      h("option", {value: ""}, texts.parameter), ...grouped(parameters).map(({title, members}) => {
        const options = members.map((i) => h("option", {value: String(i)}, label_of(parameters[i]!)));
        return h("optgroup", {label: title}, ...options);
      }));
  }

  /** A control for the value of the chosen parameter. */
  #show_value(): void {
    const about = this.#context.server.parameters[Number(this.#parameter.value)];
    if (this.#parameter.value === "" || !about) {
      this.#value.replaceChildren();
      return;
    }
    const name = texts.value_of(label_of(about));
    if (is_number(about)) {
      const {min = 0, max = 0} = about;
      this.#value.replaceChildren(h(
        "input", {class: "field wall-number", inputmode: "decimal", "aria-label": name, title: texts.range(min, max)}));
    } else {
      const choices = about.kind === "PARAMETER_KIND_FLAG" ?
        [["true", texts.on], ["false", texts.off]] :
        (about.choices ?? []).map((choice) => [choice, label_of_choice(choice)]);
      this.#value.replaceChildren(
        h("select", {class: "field", "aria-label": name},
          ...choices.map(([value, text]) => h("option", {value}, text!))));
    }
  }

  #set_parameter(): void {
    const about = this.#context.server.parameters[Number(this.#parameter.value)], field = this.#value.firstElementChild;
    if (this.#parameter.value === "" || !about || !field) {
      this.#context.notify(texts.choose_parameter);
      return;
    }
    const text = (field as HTMLInputElement | HTMLSelectElement).value;
    const number = is_number(about) ? typed_number(about, text) : null;
    if (is_number(about) && number === null) {
      this.#context.notify(texts.no_number(text));
      return;
    }
    const value = number !== null          ? value_of(about, number) :
      about.kind === "PARAMETER_KIND_FLAG" ? {flag: text === "true"} :
                                             {choice: text};
    void this.#send({set_parameters: {parameters: [{name: about.name ?? "", value}]}}, texts.set_done(label_of(about)));
  }

  #set_speed(): void {
    if (this.#speed.value !== "") {
      const speed = speed_of(this.#speed.value);
      this.#speed.value = "";
      void this.#send({set_speed: {speed}}, texts.speed_done(speed_text(speed)));
    }
  }

  #run_generations(): void {
    const generations = Number(this.#generations.value.trim());
    if (!Number.isInteger(generations) || generations < 1) {
      this.#context.notify(texts.no_number(this.#generations.value));
      return;
    }
    void this.#send({run: {generations}}, texts.generations_done(generations));
  }

  /** done: what has happened, if no world refuses. */
  async #send(action: ForEachWorld, done: string): Promise<void> {
    const {server, model, notify, attempt} = this.#context;
    await attempt(async () => {
      const {results = []} = await server.request("for_each_world", {class: model.name, ...action});
      const refused = results.filter(({status}) => status !== undefined);
      notify(refused.length === 0 ? done : texts.refused(refused.map(({world = ""}) => world), refused[0]!.status!));
    });
  }
}

function speed_of(text: string): Speed {
  return text === "max" ? {max: true} : {real_time_factor: Number(text)};
}
