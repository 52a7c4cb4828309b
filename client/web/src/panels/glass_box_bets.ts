// BetControls: the bets of the user on a breeding, and their score.
import {Bets, bets_max, score_of, score_text} from "../breeding/bets";
import type {Comparison} from "../breeding/comparison";
import {copies_so_far, type Progress} from "../breeding/progress";
import type {BreedingRecord} from "../breeding/record";
import {rank_colour, text_on} from "../breeding/wheel";
import {css} from "../render/look";
import {glass_box_texts} from "../texts/glass_box";
import {h} from "../widgets/dom";

const bets_offered_max = 200;

export class BetControls {
  readonly chosen: HTMLInputElement; // "bet first"
  closed = false; // a pick of this breeding has been shown
  #bets = new Bets();
  readonly #changed: (choice: boolean) => void;

  /** changed  called after a bet; choice: after the choice whether to bet */
  constructor(changed: (choice: boolean) => void) {
    this.#changed = changed;
    this.chosen = h("input", {type: "checkbox", onchange: () => changed(true)});
  }

  /** Another breeding begins. */
  begin(): void {
    this.#bets = new Bets();
    this.closed = false;
  }

  get any(): boolean {
    return this.#bets.organisms.length > 0;
  }

  /** Whether bets have been placed that are not decided yet. */
  get are_open(): boolean {
    return this.any && !this.closed;
  }

  /** A button for each organism, the fittest first. */
  parts(record: BreedingRecord, comparison: Comparison): Node[] {
    if (this.closed) {
      return [h("p", {}, glass_box_texts.bets_closed)];
    }
    const offered = comparison.organisms.slice(0, bets_offered_max);
    return [
      h("p", {}, glass_box_texts.bets_question(bets_max, offered.length, comparison.organisms.length)),
      h("div", {class: "glass-bets", role: "group", "aria-label": glass_box_texts.bets_label},
        ...offered.map((organism, rank) => {
          const colour = rank_colour(rank, record.contender_count);
          const button: HTMLButtonElement =
            h("button", {
              class: "glass-bet",
              "aria-pressed": String(this.#bets.has(organism)),
              title: glass_box_texts.bet_on(organism, rank, comparison.fitness[rank]!),
              onclick: () => {
                this.#bets.toggle(organism);
                button.setAttribute("aria-pressed", String(this.#bets.has(organism)));
                this.#changed(false);
              },
            },
              String(organism));
          button.style.background = css(colour);
          button.style.color = text_on(colour);
          return button;
        })),
    ];
  }

  score_line(record: BreedingRecord, comparison: Comparison|null, progress: Progress): string {
    if (!comparison || (!this.any && (!this.chosen.checked || this.closed))) {
      return "";
    }
    // The line is there before the first bet, so that a bet does not move the buttons.
    const placed = this.any ? glass_box_texts.your_bets(this.#bets.organisms) : glass_box_texts.no_bets;
    if (progress.made === 0 || !this.any) {
      return placed;
    }
    const copies = copies_so_far(record, comparison, progress);
    return `${placed} ${score_text(score_of(this.#bets, comparison, copies, progress.made), progress.complete)}`;
  }
}
