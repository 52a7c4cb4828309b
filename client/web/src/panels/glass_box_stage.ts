// Stage: the tab "Step" of the glass box, a drawing of the present moment of a breeding.
import {caption} from "../breeding/caption";
import {type Comparison, copies_after} from "../breeding/comparison";
import type {Progress} from "../breeding/progress";
import type {BreedingRecord} from "../breeding/record";
import type {Moment} from "../breeding/stepper";
import {genes_of} from "../organism/genes";
import {glass_box_texts} from "../texts/glass_box";
import {h} from "../widgets/dom";
import {hint} from "../widgets/form";
import type {ViewedWorld} from "../world/world";
import {
  descendants_legend,
  draw_descendants,
  draw_family,
  draw_picks,
  draw_ranking,
  draw_tournament,
  WheelDrawing
} from "./glass_box_drawings";

const migrants_shown_max = 8;

/** What the stage shows. */
export interface StageMoment {
  record: BreedingRecord;
  comparison: Comparison|null;
  moment: Moment;
  progress: Progress;
  width: number;
}

export class Stage {
  readonly element =
    h("div", {class: "panel glass-stage", tabindex: 0, role: "group", "aria-label": glass_box_texts.stage_label});
  #wheel: WheelDrawing|null = null;
  readonly #go_to: (stage: "picking"|"breeding", index: number) => void;

  /** go_to  shows this pick or descendant */
  constructor(go_to: (stage: "picking"|"breeding", index: number) => void) {
    this.#go_to = go_to;
  }

  /** before_picks  what stands above the ranking before the first pick: bets, and the button that plays the picks */
  draw(at: StageMoment, world: ViewedWorld, before_picks: readonly Node[]): void {
    this.element.replaceChildren(...this.#parts(at, world, before_picks));
  }

  #parts(at: StageMoment, world: ViewedWorld, before_picks: readonly Node[]): Node[] {
    const {record, comparison, moment, width} = at;
    switch (moment.stage) {
      case "scaling":
        return [
          ...before_picks,
          ...(comparison ? [draw_ranking(record, comparison, [], null, width, false)] : []),
          ...migrant_parts(record),
        ];
      case "picking":
        return [
          this.#draw_pick(at),
          draw_picks(record, moment.index, width, (index) => this.#go_to("picking", index)),
          hint(glass_box_texts.picks_legend),
        ];
      case "breeding": {
        const descendant = record.descendants[moment.index];
        const body = genes_of(world.feed.gene_groups, "body", world.gene_names.length).count;
        return [
          this.#draw_descendants(record, moment.index, width), descendants_legend(),
          ...(descendant ? [draw_family(descendant, world.gene_names, body)] : [])
        ];
      }
      case "done":
        return [
          this.#draw_descendants(record, null, width), descendants_legend(),
          ...(comparison ? [draw_ranking(record, comparison, comparison.copies, null, width, true)] : [])
        ];
    }
  }

  #draw_pick({record, comparison, moment, progress, width}: StageMoment): Element {
    const pick = record.picks[moment.index], {complete} = progress;
    if (pick?.turns !== undefined) {
      const size = Math.min(width, this.#room);
      if (!this.#wheel?.fits(record, size, complete)) {
        this.#wheel = new WheelDrawing(record, size, complete);
      }
      this.#wheel.show(moment.index, caption(record, moment));
      return this.#wheel.element;
    }
    return pick?.contestants?.length ?
      draw_tournament(record, moment.index, complete) :
      comparison ?
      draw_ranking(
        record, comparison, copies_after(record, moment.index + 1), pick ? pick.organism ?? 0 : null, width, complete) :
      h("p", {}, glass_box_texts.loading);
  }

  #draw_descendants(record: BreedingRecord, current: number|null, width: number): SVGSVGElement {
    return draw_descendants(record, current, width, (descendant) => this.#go_to("breeding", descendant));
  }

  /** The height in which the wheel is visible without scrolling, within limits. */
  get #room(): number {
    // below the wheel: the picks in order
    const panel = this.element.closest<HTMLElement>(".glass-box"),
          used = this.element.offsetTop - (panel?.offsetTop ?? 0) + 60;
    return Math.min(400, Math.max(240, Math.floor((panel?.parentElement?.clientHeight ?? 0) - used)));
  }
}

function migrant_parts(record: BreedingRecord): Node[] {
  const migrants = record.contenders.flatMap(
    ({migrant}, organism) =>
      migrant ? [glass_box_texts.migrant(organism, migrant.organism ?? 0, migrant.island ?? 0)] : []);
  return migrants.length === 0 ?
    [] :
    [hint(glass_box_texts.migrants(migrants.slice(0, migrants_shown_max), migrants.length))];
}
