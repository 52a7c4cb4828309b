// Glass box panel: shows step by step how a generation was bred, beside the law of its selection method, and why the
// means of the genes changed. While it is visible, it requests the breeding of each new generation, or of the
// generation that the user chose.
import {account_text, accounts_of, type GeneChangeOfMean, most_changed, reason_text} from "../breeding/account";
import {Bets, bets_max, score_of, score_text} from "../breeding/bets";
import {breeding_summary, caption, counted, selection_law_text} from "../breeding/caption";
import {type Comparison, compare, copies_after} from "../breeding/comparison";
import {GenerationHold} from "../breeding/generation_hold";
import {type BreedingKey, BreedingRecord, rows_kept_max, same_key} from "../breeding/record";
import {type Moment, speed_max, speed_min, Stepper} from "../breeding/stepper";
import {deviation_of, predictions, selection_of} from "../breeding/theory";
import {rank_colour, text_on} from "../breeding/wheel";
import {genes_of} from "../organism/genes";
import type {Message} from "../core/messages";
import {h, set_text, svg} from "../widgets/dom";
import {three_digits, with_separators, with_sign} from "../texts/numbers";
import type {ViewedWorld} from "../world/world";
import {css} from "../render/look";
import {
  descendants_legend,
  draw_copies,
  draw_descendants,
  draw_family,
  draw_picks,
  draw_ranking,
  draw_tournament,
  WheelDrawing
} from "./glass_box_drawings";
import type {Panel, PanelContext} from "../world/panel_context";
import {Width} from "./width";

const shown_min_ms = 500; // least time for which a breeding stays while the panel follows a fast world
const shown_after_playing_ms = 1500; // … and after the breeding was played to its end
const table_rows_max = 200;
const genes_shown_max = 12;
const bets_offered_max = 200;

type Tab = "step"|"theory"|"genes";

export class GlassBoxPanel implements Panel {
  readonly name = "glass box";
  readonly title = "Glass box";
  readonly element: HTMLElement;

  #shown: BreedingRecord|null = null;
  #next: BreedingRecord|null = null; // replaces `shown` when its first page has arrived
  #comparison: Comparison|null = null; // for `shown`; null until all contenders have arrived
  readonly #stepper = new Stepper();
  #pending = false;
  #problem = "";
  #newest = 0; // the generation before the shown one; 0: none yet
  #last = 0; // the last generation that has bred; in a replay, it may be later than the newest
  #chosen = 0;
  #next_change_ms = 0; // earliest time to show a newer generation
  #sought: number|null = null; // show the first pick of this organism
  #tab: Tab = "step";
  #drawn = ""; // what the parts show
  #wheel: WheelDrawing|null = null;
  #frame = 0;
  #bets = new Bets();
  #bets_closed = false; // a pick of this breeding has been shown
  readonly #holder = new GenerationHold();

  // ---- elements ----
  readonly #generation: HTMLInputElement = h("input", {
    class: "field glass-generation",
    type: "number",
    min: 1,
    step: 1,
    "aria-label": "Generation of the parents",
    onchange: () => this.#choose(Number(this.#generation.value))
  });
  readonly #follow: HTMLInputElement = h("input", {type: "checkbox", checked: true, onchange: () => this.refresh()});
  readonly #play_each: HTMLInputElement = h("input", {type: "checkbox"});
  readonly #betting: HTMLInputElement = h("input", {type: "checkbox", onchange: () => this.#redraw()});
  readonly #held: HTMLInputElement = h("input", {type: "checkbox", onchange: () => this.#set_hold()});
  readonly #held_row =
    h("label", {
      class: "check",
      title: "While this panel is open, pauses the world after each generation, one tick into the next. Resuming runs " +
        "one more generation.",
    },
      this.#held, "hold the world");
  readonly #score = h("p", {class: "glass-score", role: "status"});
  readonly #birth =
    h("button", {class: "button", onclick: () => this.#go_to_birth()}, "birth of the selected organism");
  readonly #summary = h("p", {class: "hint"});
  readonly #error = h("p", {class: "error", role: "status"});
  readonly #retry = h("button", {class: "button", onclick: () => this.#try_again()}, "Retry");
  readonly #waiting = h("p", {});
  readonly #play =
    h("button", {
      class: "button glass-play",
      title: "Plays or stops (Space).",
      onclick: () => this.#move(() => this.#stepper.play_or_stop())
    },
      "Play");
  readonly #speed = h("input", {
    class: "glass-speed",
    type: "range",
    min: Math.log2(speed_min),
    max: Math.log2(speed_max),
    step: "any",
    value: 1,
    "aria-label": "Steps per second",
    oninput: () => this.#set_speed(),
  });
  readonly #speed_text = h("span", {class: "hint"});
  readonly #position: HTMLInputElement = h("input", {
    class: "grow",
    type: "range",
    min: 0,
    step: 1,
    "aria-label": "Step",
    oninput: () => this.#move(() => this.#stepper.go_to(Number(this.#position.value)))
  });
  readonly #position_text = h("span", {class: "hint glass-position"});
  readonly #tabs = (["step", "theory", "genes"] as const)
                     .map(
                       (tab) =>
                         h("button", {
                           class: "button",
                           "aria-pressed": String(tab === this.#tab),
                           onclick: () => this.#open_tab(tab),
                         },
                           tab === "step"     ? "Step" :
                             tab === "theory" ? "Theory" :
                                                "Why genes changed"));
  readonly #caption = h("p", {class: "glass-caption", "aria-live": "polite"});
  readonly #stage = h("div", {
    class: "panel glass-stage",
    tabindex: 0,
    role: "group",
    "aria-label": "Steps of the breeding. Left and right arrow: one step; Page Up, Page Down: stage; Space: play"
  });
  readonly #play_all = h("button", {class: "button button-primary", onclick: () => this.#play_picks()});
  readonly #theory = h("div", {class: "panel"});
  readonly #genes = h("div", {class: "panel"});
  readonly #body: HTMLElement;
  readonly #width: Width;

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    const button = (text: string, label: string, act: () => void): HTMLElement => h(
      "button", {class: "button glass-move", title: label, "aria-label": label, onclick: () => this.#move(act)}, text);
    this.#body =
      h("div", {class: "panel"},
        h("div", {class: "glass-transport"}, button("|<", "To the beginning (Home)", () => this.#stepper.go_to(0)),
          button("<<", "To the previous stage (Page Up)", () => this.#stepper.previous_stage()),
          button("<", "One step back (←)", () => this.#stepper.back()), this.#play,
          button(">", "One step forward (→)", () => this.#stepper.step()),
          button(">>", "To the next stage (Page Down)", () => this.#stepper.next_stage()),
          button(">|", "To the end (End)", () => this.#stepper.go_to(this.#stepper.last_position))),
        h("div", {class: "row"}, this.#position, this.#position_text),
        h("div", {class: "row"}, this.#speed, this.#speed_text),
        h("div", {class: "row glass-tabs", role: "group", "aria-label": "What to show"}, ...this.#tabs), this.#caption,
        this.#score, this.#stage, this.#theory, this.#genes);
    this.element =
      h("div", {class: "panel glass-box", onkeydown: (event: KeyboardEvent) => this.#press(event)},
        h("div", {class: "row"}, h("span", {}, "Generation"), this.#generation,
          h("label", {
            class: "check",
            title: "Shows each new breeding when the steps of the last one are at their beginning or end."
          },
            this.#follow, "the newest"),
          h("label", {
            class: "check",
            title: "Bet on the organisms that will be picked. The score compares the bets with random ones."
          },
            this.#betting, "bet first"),
          h("label",
            {class: "check", title: "Plays each breeding from the start when it appears; with bets, after the bets."},
            this.#play_each, "play each"),
          this.#held_row, this.#birth),
        this.#summary, this.#error, this.#retry, this.#waiting, this.#body);
    this.#width = new Width(this.element, () => this.refresh());
    this.#set_speed();
  }

  /** subject  {generation, organism}: shows the first pick of this organism when its generation bred. */
  show(subject: {[key: string]: unknown}): void {
    if (typeof subject.generation === "number") {
      this.#follow.checked = false;
      this.#chosen = subject.generation;
      this.#sought = typeof subject.organism === "number" ? subject.organism : null;
      this.#tab = "step";
    }
    this.refresh();
  }

  refresh(): void {
    const world = this.#context.world();
    this.#choose_record(world);
    this.#seek_pick();
    this.#request(world);
    this.#bets_closed ||= this.#stepper.moment.stage !== "scaling";
    this.#hold_world(world);
    this.#draw(world);
    this.#animate();
  }

  // ---- which generation is shown, and what to request ----

  #choose(generation: number): void {
    this.#follow.checked = false;
    this.#sought = null;
    if (Number.isInteger(generation)) {
      this.#chosen = generation;
    }
    this.refresh();
  }

  #choose_record(world: ViewedWorld): void {
    const snapshot = world.snapshot;
    if (!snapshot) {
      this.#forget();
      return;
    }
    const of = {world: world.shown, run_id: snapshot.run_id, island: world.island};
    this.#newest = Math.max(0, snapshot.generation - 1);
    const replay = world.info?.replay;
    this.#last = replay ? Math.max(this.#newest + 1, Number(replay.last_generation ?? 0)) - 1 : this.#newest;
    const is_of = (record: BreedingRecord|null): boolean =>
      record !== null && same_key({...of, generation: record.key.generation}, record.key);
    // A replay shows the same run as the live world, so its breedings are the same.
    if (
      this.#shown && !is_of(this.#shown) &&
      (this.#shown.key.run_id !== of.run_id || this.#shown.key.island !== of.island)) {
      this.#shown = null;
      this.#comparison = null;
      this.#stepper.load(0, 0);
    }
    if (!is_of(this.#next)) {
      this.#next = null;
    }
    if (this.#last === 0) {
      return;
    }
    const now = performance.now();
    if (this.#stepper.playing) {
      this.#next_change_ms = now + shown_after_playing_ms;
    }
    // Wait for a pending answer before requesting a newer generation. In a fast world there is always a newer one, so
    // the panel would never show a generation.
    const idle = this.#next === null || this.#problem !== "";
    const bets_open = this.#bets.organisms.length > 0 && !this.#bets_closed;
    const settled = !this.#stepper.playing && !bets_open && (this.#stepper.at_begin || this.#stepper.at_end);
    if (this.#follow.checked && this.#newest > 0 && idle && settled && now >= this.#next_change_ms) {
      this.#chosen = this.#newest;
    }
    this.#chosen = Math.min(Math.max(this.#chosen, 1), this.#last);
    const key: BreedingKey = {...of, generation: this.#chosen};
    const current = this.#next ?? this.#shown;
    if (
      !current || current.key.generation !== key.generation || current.key.run_id !== key.run_id ||
      current.key.island !== key.island) {
      this.#next = new BreedingRecord(key);
      this.#problem = "";
      this.#next_change_ms = now + shown_min_ms;
    }
  }

  #forget(): void {
    this.#shown = this.#next = this.#comparison = null;
    this.#newest = this.#last = 0;
    this.#stepper.load(0, 0);
  }

  #request(world: ViewedWorld): void {
    const record = this.#next ?? this.#shown;
    if (!record || this.#pending || this.#problem !== "") {
      return;
    }
    // While a pick is sought, all picks are needed.
    const needed: Moment = this.#next ? {stage: "scaling", index: 0} :
      this.#sought !== null           ? {stage: "picking", index: record.pick_count} :
                                        this.#stepper.moment;
    const fields = record.wanted(needed);
    if (!fields) {
      return;
    }
    this.#pending = true;
    world.server.request("get_breeding", {...fields, world: world.shown})
      .then(
        (breeding) => this.#receive(record, breeding),
        (error: Error) => {
          if (record === this.#next || record === this.#shown) {
            this.#problem = error.message;
          }
        })
      .finally(() => {
        this.#pending = false;
        this.refresh();
      });
  }

  #receive(record: BreedingRecord, breeding: Message): void {
    if (record !== this.#next && record !== this.#shown) {
      return; // another generation was chosen meanwhile
    }
    if (!record.add(breeding)) {
      this.#problem =
        `The server sent the breeding of a generation other than ${with_separators(record.key.generation)}`;
      return;
    }
    if (record === this.#next) {
      const at_end = this.#shown !== null && this.#stepper.at_end && !this.#stepper.at_begin;
      this.#shown = record;
      this.#next = null;
      this.#comparison = null;
      this.#stepper.load(record.pick_count, record.descendant_count);
      this.#bets = new Bets();
      this.#bets_closed = false;
      if (this.#betting.checked) {
        // The bets come first.
      } else if (this.#play_each.checked) {
        this.#stepper.play();
      } else if (at_end) {
        this.#stepper.go_to(this.#stepper.last_position); // the user skipped the steps of the previous breeding
      }
    }
    this.#comparison ??= compare(record);
  }

  #try_again(): void {
    this.#problem = "";
    this.refresh();
  }

  /** Steps to the first pick of the sought organism as soon as this pick has been received. */
  #seek_pick(): void {
    if (this.#sought === null || this.#next || !this.#shown) {
      return;
    }
    const found = this.#shown.picks.findIndex((pick) => (pick.organism ?? 0) === this.#sought);
    // the last pick if the organism was not picked
    if (found >= 0 || this.#shown.picks.length >= this.#shown.pick_count) {
      this.#stepper.go_to(found >= 0 ? 1 + found : this.#shown.pick_count);
      if (found < 0) {
        this.#context.notify(
          `Organism ${this.#sought} was not picked when generation ${with_separators(this.#shown.key.generation)} ` +
          "bred.");
      }
      this.#sought = null;
    }
  }

  #go_to_birth(): void {
    const selected = this.#context.world().selection.id;
    if (this.#shown && selected !== null) {
      this.#open_tab("step");
      this.#move(() => this.#stepper.go_to(this.#stepper.begin_of("breeding") + selected));
    }
  }

  // ---- the hold ----

  #may_hold(world: ViewedWorld): boolean {
    return !world.is_replay && world.server.may("run", world.shown) && world.server.may("run_until_tick", world.shown);
  }

  #set_hold(): void {
    const world = this.#context.world();
    if (this.#held.checked) {
      this.#holder.hold(run_of(world));
    } else {
      this.#holder.release();
    }
    this.refresh();
  }

  #hold_world(world: ViewedWorld): void {
    const may = this.#may_hold(world);
    if (!may) {
      this.#holder.release();
    }
    this.#held_row.hidden = !may;
    const action =
      this.#holder.update(run_of(world), world.info?.state ?? "", world.info?.run_until_tick !== undefined);
    this.#held.checked = this.#holder.on;
    if (action !== "none") {
      void this.#context.attempt(() => action === "step one tick" ? world.control.step(1) : world.control.run(1));
    }
  }

  // ---- steps ----

  #move(act: () => void): void {
    act();
    this.refresh();
  }

  #set_speed(): void {
    this.#stepper.speed = 2 ** Number(this.#speed.value);
    set_text(this.#speed_text, `${three_digits(this.#stepper.speed)} steps/s`);
    this.#speed.setAttribute("aria-valuetext", `${three_digits(this.#stepper.speed)} steps per second`);
  }

  #press(event: KeyboardEvent): void {
    const target = event.target as HTMLElement;
    const is_field = target instanceof HTMLInputElement;
    const act: {[key: string]: () => void} = {
      ArrowLeft: () => this.#stepper.back(),
      ArrowRight: () => this.#stepper.step(),
      PageUp: () => this.#stepper.previous_stage(),
      PageDown: () => this.#stepper.next_stage(),
      Home: () => this.#stepper.go_to(0),
      End: () => this.#stepper.go_to(this.#stepper.last_position),
      " ": () => this.#stepper.play_or_stop(),
    };
    if (
      is_field || !this.#shown || !act[event.key] || event.ctrlKey || event.altKey || event.metaKey ||
      (event.key === " " && target instanceof HTMLButtonElement)) {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
    this.#move(act[event.key]!);
  }

  /** Plays while the panel is visible. */
  #animate(): void {
    if (!this.#stepper.playing || this.#frame !== 0) {
      return;
    }
    let before = performance.now();
    const step = (now: number): void => {
      this.#frame = 0;
      if (!this.#stepper.playing || this.element.offsetParent === null) {
        return;
      }
      const moment = this.#stepper.moment, record = this.#shown;
      const here = moment.stage === "picking" ? record?.picks[moment.index] :
        moment.stage === "breeding"           ? record?.descendants[moment.index] :
                                                record;
      if (here) { // otherwise playing waits until the row has arrived
        this.#stepper.advance(Math.min((now - before) / 1000, 0.25));
      }
      before = now;
      this.refresh();
      this.#frame ||= this.#stepper.playing ? requestAnimationFrame(step) : 0;
    };
    this.#frame = requestAnimationFrame(step);
  }

  get #picks_made(): number {
    const moment = this.#stepper.moment;
    return moment.stage === "scaling" ? 0 :
      moment.stage === "picking"      ? moment.index + 1 :
                                        this.#shown?.head?.pick_count ?? 0;
  }

  get #picks_complete(): boolean {
    return this.#stepper.moment.stage !== "scaling" && this.#picks_made >= (this.#shown?.head?.pick_count ?? 0);
  }

  // ---- drawing ----

  #open_tab(tab: Tab): void {
    this.#tab = tab;
    this.refresh();
  }

  #redraw(): void {
    this.#drawn = "";
    this.refresh();
  }

  #draw(world: ViewedWorld): void {
    const record = this.#shown;
    if (document.activeElement !== this.#generation) {
      this.#generation.value = String(this.#chosen || "");
    }
    this.#generation.max = String(this.#last || "");
    this.#generation.disabled = this.#last === 0;
    this.#birth.hidden = !record || world.selection.id === null || record.key.generation !== this.#newest ||
      world.selection.id >= record.descendant_count;
    set_text(this.#error, this.#problem ? `${this.#problem}.` : "");
    this.#retry.hidden = this.#problem === "";
    set_text(
      this.#summary,
      record ?
        `World ${world.name}, generation ${with_separators(record.key.generation)}: ${breeding_summary(record)}` :
        "");
    set_text(
      this.#waiting,
      record             ? "" :
        !world.snapshot  ? "Waiting for the first snapshot …" :
        this.#last === 0 ? "No generation has bred yet. The first one breeds when it ends and the next begins." :
        this.#problem    ? "" :
                           "Loading …");
    this.#waiting.hidden = record !== null;
    this.#body.hidden = record === null;
    if (!record) {
      this.#drawn = "";
      return;
    }
    set_text(this.#play, this.#stepper.playing ? "Stop" : "Play");
    this.#position.max = String(this.#stepper.last_position);
    this.#position.value = String(this.#stepper.position);
    set_text(
      this.#position_text,
      `step ${with_separators(this.#stepper.position)} of ${with_separators(this.#stepper.last_position)}`);
    this.#tabs.forEach(
      (button, i) =>
        button.setAttribute("aria-pressed", String((["step", "theory", "genes"] as const)[i] === this.#tab)));
    this.#caption.hidden = this.#stage.hidden = this.#tab !== "step";
    set_text(
      this.#play_all,
      `${this.#betting.checked && this.#bets.organisms.length > 0 ? "Close the bets and play the" : "Play the"} ` +
        `${counted(record.pick_count, "pick", "picks")}`);
    set_text(this.#score, this.#score_line(record));
    this.#score.hidden = this.#tab === "genes" || this.#score.textContent === "";
    this.#theory.hidden = this.#tab !== "theory";
    this.#genes.hidden = this.#tab !== "genes";
    const width = this.#width.within(280, 560);
    const next = this.#next_statistics(world);
    const drawn = [
      this.#tab, record.key.run_id, record.key.island, record.key.generation, this.#stepper.position,
      record.contenders.length, record.picks.length, record.descendants.length, width, world.gene_names.length,
      this.#tab === "genes" && next !== null, this.#bets_closed
    ].join("/");
    if (drawn === this.#drawn) {
      return;
    }
    this.#drawn = drawn;
    if (this.#tab === "step") {
      set_text(this.#caption, caption(record, this.#stepper.moment));
      this.#caption.setAttribute("aria-live", this.#stepper.playing ? "off" : "polite");
      this.#stage.replaceChildren(...this.#stage_parts(world, record, width));
    } else if (this.#tab === "theory") {
      this.#theory.replaceChildren(...this.#theory_parts(record, width));
    } else {
      this.#genes.replaceChildren(...this.#gene_parts(world, record, next));
    }
  }

  #stage_parts(world: ViewedWorld, record: BreedingRecord, width: number): Node[] {
    const moment = this.#stepper.moment, comparison = this.#comparison;
    switch (moment.stage) {
      case "scaling": {
        const migrants = record.contenders.flatMap(
          (contender, organism) => contender.migrant ?
            [`organism ${organism} is a copy of organism ${contender.migrant.organism ?? 0} of island ` +
             `${contender.migrant.island ?? 0}`] :
            []);
        return [
          ...(this.#betting.checked && comparison ? this.#bet_parts(record, comparison) : []),
          this.#play_all,
          ...(comparison ? [draw_ranking(record, comparison, [], null, width, false)] : []),
          ...(
            migrants.length > 0 ?
              [h(
                "p", {class: "hint"},
                `${counted(migrants.length, "organism", "organisms")} migrated to this island before the selection: ` +
                  `${migrants.slice(0, 8).join("; ")}` +
                  (migrants.length > 8 ? `; and ${migrants.length - 8} more.` : "."))] :
              []),
        ];
      }
      case "picking": {
        const pick = record.picks[moment.index], complete = this.#picks_complete;
        const main = pick?.turns !== undefined ?
          this.#wheel_of(record, moment.index, Math.min(width, this.#room), complete) :
          pick?.contestants?.length > 0 ? draw_tournament(record, moment.index, complete) :
          comparison                    ? draw_ranking(
                                            record, comparison, copies_after(record, moment.index + 1), pick ? pick.organism ?? 0 : null,
                                            width, complete) :
                       h("p", {}, "Loading …");
        return [
          main, draw_picks(record, moment.index, width, (index) => this.#move(() => this.#stepper.go_to(1 + index))),
          h("p", {class: "hint"}, "picks in order; light: fittest, dark: lowest rank")
        ];
      }
      case "breeding": {
        const descendant = record.descendants[moment.index];
        const body = genes_of(world.feed.gene_groups, "body", world.gene_names.length).count;
        return [
          this.#descendants(record, moment.index, width), descendants_legend(),
          ...(descendant ? [draw_family(descendant, world.gene_names, body)] : [])
        ];
      }
      case "done":
        return [
          this.#descendants(record, null, width), descendants_legend(),
          ...(comparison ? [draw_ranking(record, comparison, comparison.copies, null, width, true)] : [])
        ];
    }
  }

  /** A button for each organism, the fittest first. */
  #bet_parts(record: BreedingRecord, comparison: Comparison): Node[] {
    if (this.#bets_closed) {
      return [h(
        "p", {},
        "The bets are closed, because picks of this breeding have been shown. " +
          "Choose another generation to bet again.")];
    }
    const offered = comparison.organisms.slice(0, bets_offered_max);
    return [
      h("p", {},
        `Which organisms will be picked most often? Choose up to ${bets_max}. ` +
          (offered.length < comparison.organisms.length ?
             `The ${offered.length} fittest organisms are offered, by rank.` :
             "The fittest organism comes first.")),
      h("div", {class: "glass-bets", role: "group", "aria-label": "Bets"}, ...offered.map((organism, rank) => {
        const colour = rank_colour(rank, record.contender_count);
        const button: HTMLButtonElement =
          h("button", {
            class: "glass-bet",
            "aria-pressed": String(this.#bets.has(organism)),
            title: `organism ${organism}: rank ${rank + 1}, fitness ${three_digits(comparison.fitness[rank]!)}`,
            onclick: () => {
              this.#bets.toggle(organism);
              button.setAttribute("aria-pressed", String(this.#bets.has(organism)));
              this.refresh();
            },
          },
            String(organism));
        button.style.background = css(colour);
        button.style.color = text_on(colour);
        return button;
      })),
    ];
  }

  #score_line(record: BreedingRecord): string {
    const bets = this.#bets, comparison = this.#comparison, made = this.#picks_made;
    if ((bets.organisms.length === 0 && (!this.#betting.checked || this.#bets_closed)) || !comparison) {
      return "";
    }
    // The line is there before the first bet, so that a bet does not move the buttons.
    const placed = bets.organisms.length === 0 ? "Your bets: none yet." : `Your bets: ${bets.organisms.join(", ")}.`;
    if (made === 0 || bets.organisms.length === 0) {
      return placed;
    }
    const complete = this.#picks_complete;
    const copies = complete ? comparison.copies : copies_after(record, made);
    return `${placed} ${score_text(score_of(bets, comparison, copies, made), complete)}`;
  }

  /** The height in which the wheel is visible without scrolling, within limits. */
  get #room(): number {
    // below the wheel: the picks in order
    const body = this.element.parentElement, used = this.#stage.offsetTop - this.element.offsetTop + 60;
    return Math.min(400, Math.max(240, Math.floor((body?.clientHeight ?? 0) - used)));
  }

  #wheel_of(record: BreedingRecord, index: number, size: number, complete: boolean): SVGSVGElement {
    if (!this.#wheel?.fits(record, size, complete)) {
      this.#wheel = new WheelDrawing(record, size, complete);
    }
    this.#wheel.show(index, caption(record, this.#stepper.moment));
    return this.#wheel.element;
  }

  #descendants(record: BreedingRecord, current: number|null, width: number): SVGSVGElement {
    return draw_descendants(
      record, current, width,
      (descendant) => this.#move(() => this.#stepper.go_to(this.#stepper.begin_of("breeding") + descendant)));
  }

  #play_picks(): void {
    this.#move(() => {
      this.#stepper.step();
      this.#stepper.play();
    });
    this.#stage.focus();
  }

  #theory_parts(record: BreedingRecord, width: number): Node[] {
    const law = h("p", {}, selection_law_text(record));
    const comparison = this.#comparison;
    if (!comparison) {
      return [
        law,
        h("p", {class: "hint"},
          record.contender_count > rows_kept_max ?
            `Theory needs all organisms; only the first ${with_separators(rows_kept_max)} are requested.` :
            `${with_separators(record.contenders.length)} of ${with_separators(record.contender_count)} organisms ` +
              "received …")
      ];
    }
    const picks = record.head?.pick_count ?? 0, made = this.#picks_made, complete = this.#picks_complete;
    const copies = complete ? comparison.copies : copies_after(record, made);
    const number = (value: number|null, unit: string): string =>
      value === null ? "–" : `${three_digits(Math.abs(value) < 1e-12 ? 0 : value)}${unit && " "}${unit}`;
    const off_text = (off: number): string => Number.isFinite(off) ? with_sign(off) : off > 0 ? "∞" : "−∞";
    const rows =
      comparison.organisms.slice(0, table_rows_max)
        .map(
          (organism, rank) =>
            h("tr", {}, h("td", {class: "number"}, with_separators(rank + 1)),
              h("td", {class: "number"}, String(organism)),
              h("td", {class: "number"}, three_digits(comparison.fitness[rank]!)),
              h("td", {class: "number"},
                `${three_digits(comparison.expected[rank]!)} ± ${three_digits(comparison.standard_error[rank]!)}`),
              h("td", {class: "number"}, with_separators(copies[rank]!)),
              h("td", {class: "number"}, complete ? off_text(comparison.deviations[rank]!) : "")));
    return [
      law,
      draw_copies(record, comparison, copies, picks > 0 ? made / picks : 1, complete, width),
      h("p", {},
        complete ?
          `${with_separators(comparison.beyond_two)} of ${with_separators(comparison.organisms.length)} ranks ` +
            "deviate by more than two standard errors" :
          `After ${with_separators(made)} of ${counted(picks, "pick", "picks")}. The deviations appear after the ` +
            "last pick."),
      ...predictions(selection_of(record), comparison).map((prediction) => {
        const off = deviation_of(prediction), observed = complete ? prediction.observed : null;
        return h(
          "section", {class: "organism-part"},
          h("p", {},
            `${prediction.name}: expected ${number(prediction.expected, prediction.unit)}` +
              (observed === null ? "" : `, observed ${number(observed, prediction.unit)}`)),
          complete && off !== null && h("p", {}, `${off_text(off)} standard errors`),
          h("p", {class: "hint"}, `${prediction.sentence} (${prediction.source})`));
      }),
      h("details", {}, h("summary", {}, "All organisms as a table"),
        h("div", {class: "glass-table"},
          h("table", {class: "table"},
            h("thead", {},
              h("tr", {},
                ...["rank", "organism", "fitness", "expected", "picks", "off"].map(
                  (name) => h("th", {scope: "col", class: "number"}, name)))),
            h("tbody", {}, ...rows))),
        comparison.organisms.length > table_rows_max &&
          h("p", {class: "hint"},
            `The ${table_rows_max} fittest of ${with_separators(comparison.organisms.length)} organisms.`)),
    ];
  }

  /** Statistics of the generation that the shown breeding made; null until that generation has ended. */
  #next_statistics(world: ViewedWorld): Message|null {
    const key = this.#shown?.key;
    const history = world.history.generations;
    for (let i = history.length - 1; key && i >= 0 && history[i]!.generation > key.generation; --i) {
      if (history[i]!.generation === key.generation + 1 && (history[i]!.island ?? 0) === key.island) {
        return history[i]!;
      }
    }
    return null;
  }

  #gene_parts(world: ViewedWorld, record: BreedingRecord, next: Message|null): Node[] {
    const generation = record.key.generation, accounts = accounts_of(next, world.gene_names);
    if (accounts.length === 0) {
      return [h(
        "p", {},
        next ?
          "The server does not know why the means of the genes changed." :
          `The account appears when generation ${with_separators(generation + 1)} has ended, if the server still ` +
            "keeps its statistics.")];
    }
    const shown = accounts.length > genes_shown_max ? most_changed(accounts, genes_shown_max) : accounts;
    const most = Math.max(
      1e-12,
      ...shown.flatMap(
        (account) => [account.selection, account.transmission, account.migration, account.change].map(Math.abs)));
    return [
      h("p", {},
        `Why the mean of each gene changed from generation ${with_separators(generation)} to ` +
          `${with_separators(generation + 1)}, by Price's equation: the change is selection ` +
          "(which organisms had offspring) + transmission (crossover and mutation) + migration."),
      ...(
        shown.length < accounts.length ?
          [h(
            "p", {class: "hint"},
            `The ${shown.length} of ${with_separators(accounts.length)} genes whose means changed most, in standard ` +
              "deviations.")] :
          []),
      ...shown.map((account) => draw_account(account, accounts.length > genes_shown_max ? null : most)),
    ];
  }
}

/** One gene: its sentence, and a bar for each part of the change. most: the end of the axis; null: that of this gene
 *  alone. */
function draw_account(account: GeneChangeOfMean, most: number|null): HTMLElement {
  const parts = [
    ["selection", account.selection], ["transmission", account.transmission], ["migration", account.migration],
    ["change", account.change]
  ] as const;
  const end = most ?? Math.max(1e-12, ...parts.map(([, value]) => Math.abs(value)));
  return h(
    "section", {class: "organism-part account"}, h("p", {}, account_text(account)),
    h("p", {class: "hint"}, reason_text(account)),
    h("div", {class: "account-bars", "aria-hidden": "true"}, ...parts.flatMap(([name, value]) => {
      const width = Math.abs(value) / end * 50;
      return [
        h("span", {class: "hint"}, name),
        svg(
          "svg", {class: "account-bar", viewBox: "0 0 100 10", preserveAspectRatio: "none"},
          svg("rect", {class: name, x: value < 0 ? 50 - width : 50, y: 1, width, height: 8}),
          svg("line", {class: "axis", x1: 50, x2: 50, y1: 0, y2: 10}))
      ];
    })));
}

/** Identifies the held run. A replay has the same run id as the run that it shows, but its own world name. */
function run_of(world: ViewedWorld): string {
  return `${world.shown} ${world.snapshot?.run_id ?? ""}`;
}
