// CompareChoice: what the plots compare the world with: another world of the server, or a CSV file, which the user
// chooses or drops.
import type {Comparison} from "../plots/comparison";
import {plots_panel_texts as texts} from "../texts/plots_panel";
import {set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {open_button} from "../widgets/files";
import {button} from "../widgets/form";
import type {Server} from "../world/server";

const file_value = "file", world_value = "world "; // of options

export class CompareChoice {
  readonly element: HTMLElement;
  readonly #server: Server;
  readonly #comparison: Comparison;
  readonly #compare = h("select", {class: "field", onchange: () => this.#choose()});
  readonly #file_name = h("span", {class: "grow"});
  readonly #run =
    h("select",
      {class: "field grow", "aria-label": texts.run, onchange: () => this.#comparison.choose_run(this.#run_index())});
  readonly #remove = button(texts.remove, () => this.#remove_file());
  readonly #file_row = h("div", {class: "row plots-file", hidden: true}, this.#file_name, this.#run, this.#remove);
  readonly #problem = h("p", {class: "error", role: "alert"});

  constructor(server: Server, comparison: Comparison) {
    this.#server = server;
    this.#comparison = comparison;
    const [open, field] = open_button(texts.open_file, ".csv,text/csv", false, (files) => this.take(files));
    open.title = texts.open_file_help;
    this.element =
      h("div", {class: "panel"},
        h("div", {class: "row plots-choices"},
          h("label", {class: "row grow"}, h("span", {}, texts.compare), this.#compare), open, field),
        this.#file_row, this.#problem);
  }

  /** Compares with the first of the files. */
  take(files: readonly File[]): void {
    if (files[0] !== undefined) {
      void this.#comparison.choose_file(files[0]);
    }
  }

  /** world: the name of the shown world. */
  update(world: string): void {
    const others = this.#server.worlds.all.filter((one) => !one.replay && one.name !== world);
    const names = others.map((one) => one.name);
    const {file} = this.#comparison, compared = this.#comparison.world;
    if (compared !== "" && !names.includes(compared)) { // it was deleted, or is shown itself now
      this.#comparison.choose_world("");
      return;
    }
    set_options(
      this.#compare,
      [
        {value: "", text: texts.nothing}, ...names.map((name) => ({value: world_value + name, text: name})),
        ...(file === null ? [] : [{value: file_value, text: file.name}])
      ],
      file !== null     ? file_value :
        compared === "" ? "" :
                          world_value + compared);
    this.#file_row.hidden = file === null;
    if (file !== null) {
      set_text(this.#file_name, texts.compared_file(file.name));
      this.#remove.title = texts.remove_help(file.name);
      this.#run.hidden = file.csv.runs.length < 2;
      set_options(this.#run, file.csv.runs.map(({name}, i) => ({value: String(i), text: name})), String(file.run));
    }
    set_text(this.#problem, this.#comparison.problem);
  }

  #choose(): void {
    if (this.#compare.value !== file_value) {
      this.#comparison.choose_world(this.#compare.value.slice(world_value.length));
    }
  }

  #run_index(): number {
    return this.#run.selectedIndex;
  }

  #remove_file(): void {
    this.#comparison.choose_world("");
    this.#compare.focus();
  }
}
