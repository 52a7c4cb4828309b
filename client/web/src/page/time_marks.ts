// TimeMarks: what stands on the time line: labels of generations, and marks where parameters changed and where all
// organisms died. They are rebuilt after a change, but not more often than every rebuild_ms.
import type {GenerationStatistics} from "../core/protocol";
import {marks_of} from "../plots/change_marks";
import {with_separators} from "../texts/numbers";
import {timeline_texts} from "../texts/timeline";
import {h} from "../widgets/dom";
import {type JoinedMark, joined_marks, marked_generations, type TimeScale} from "../world/time_scale";
import type {ViewedWorld} from "../world/world";

const label_room_px = 56; // between labels
const mark_slots = 160; // marks on the line at most, of each kind
const rebuild_ms = 250; // between two rebuilds
const extinctions_share_max = 0.1; // if more generations end so, extinctions are the rule and have no marks

export class TimeMarks {
  readonly labels = h("div", {class: "time-labels"});
  readonly marks = h("div", {class: "time-marks"});

  readonly #world: ViewedWorld;
  readonly #rebuild: () => void;
  #extinctions: number[] = []; // generations, oldest first
  /** How far #extinctions describes the history. */
  #scanned: {first: GenerationStatistics|undefined; island: number; generation: number}|null = null;
  #texts: JoinedMark[] = [];
  #drawn = ""; // what labels and marks show
  #rebuilt_ms = -rebuild_ms;
  #timer = 0;

  /** rebuild: is called later if it is too early for a rebuild, and calls refresh(). */
  constructor(world: ViewedWorld, rebuild: () => void) {
    this.#world = world;
    this.#rebuild = rebuild;
  }

  close(): void {
    clearTimeout(this.#timer);
  }

  /** The texts of the marks near a position, which is 0 to 1. */
  texts_at(part: number, near: number): string[] {
    return this.#texts.filter((mark) => Math.abs(mark.part - part) <= near).flatMap(({texts}) => texts);
  }

  refresh(scale: TimeScale, width_px: number): void {
    const world = this.#world, {first_generation, last_generation} = scale.range;
    const of_run = [world.name, world.island, first_generation, last_generation];
    const key =
      [...of_run, world.history.generations.length, world.history.changes.length, Math.round(width_px)].join(" ");
    if (key === this.#drawn || this.#timer !== 0) {
      return;
    }
    const wait_ms = this.#rebuilt_ms + rebuild_ms - performance.now();
    if (wait_ms > 0) {
      this.#timer = window.setTimeout(() => {
        this.#timer = 0;
        this.#rebuild();
      }, wait_ms);
      return;
    }
    this.#rebuilt_ms = performance.now();
    this.#drawn = key;
    const labelled = marked_generations(first_generation, last_generation, Math.floor(width_px / label_room_px));
    this.labels.replaceChildren(...labelled.map((generation) => {
      const label = h("span", {}, with_separators(generation));
      label.style.left = percent(scale.part_of(generation));
      return label;
    }));
    this.#build_marks(scale);
  }

  #build_marks(scale: TimeScale): void {
    this.#scan_extinctions();
    const {first_generation, last_generation} = scale.range;
    const marks_at = (marks: {x: number; text: string}[]): JoinedMark[] => {
      const shown = marks.filter(({x}) => x >= first_generation && x <= last_generation);
      return joined_marks(shown.map(({x, text}) => ({part: scale.part_of(x), text})), mark_slots);
    };
    const are_rare = this.#extinctions.length <= extinctions_share_max * (last_generation - first_generation + 1);
    const changes = marks_at(marks_of(this.#world.history.changes));
    const extinctions =
      marks_at((are_rare ? this.#extinctions : [])
                 .map((generation) => ({x: generation, text: timeline_texts.extinction(generation)})));
    const mark = (kind: string) => ({part}: {part: number}): HTMLElement => {
      const made = h("i", {"data-kind": kind});
      made.style.left = percent(part);
      return made;
    };
    this.#texts = [...changes, ...extinctions];
    this.marks.replaceChildren(...changes.map(mark("change")), ...extinctions.map(mark("extinction")));
  }

  /** Adds the extinctions of the generations that have ended since the last call. */
  #scan_extinctions(): void {
    const {history: {generations: history}, island} = this.#world;
    if (!this.#scanned || this.#scanned.first !== history[0] || this.#scanned.island !== island) {
      this.#extinctions = [];
      this.#scanned = {first: history[0], island, generation: 0};
    }
    const fresh: number[] = [];
    for (let i = history.length - 1; i >= 0; --i) {
      const {generation = 0, island: of = 0, alive_count = 0, organism_count = 0} = history[i]!;
      if (generation <= this.#scanned.generation) {
        break;
      }
      if (of === island && alive_count === 0 && organism_count > 0) {
        fresh.push(generation);
      }
    }
    this.#extinctions.push(...fresh.reverse());
    this.#scanned.generation = history[history.length - 1]?.generation ?? 0;
  }
}

export function percent(part: number): string {
  return `${(100 * part).toFixed(3)}%`;
}
