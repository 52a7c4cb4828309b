// TimeMarks: what stands on the time line: labels of generations, and marks where parameters changed, where all
// organisms died, and of what the page has seen happen: placed, removed, migrated, forked. Where there is room, a mark
// has its name next to it. They are rebuilt after a change, but not more often than every rebuild_ms.
import type {GenerationStatistics} from "../core/protocol";
import {marks_of} from "../plots/change_marks";
import {with_separators} from "../texts/numbers";
import {timeline_texts} from "../texts/timeline";
import {h} from "../widgets/dom";
import {type JoinedMark, joined_marks, marked_generations, type TimeScale} from "../world/time_scale";
import type {ViewedWorld} from "../world/world";
import {SeenEvents} from "./seen_events";

const label_room_px = 56; // between labels
const mark_slots = 160; // marks on the line at most, of each kind
const rebuild_ms = 250; // between two rebuilds
const share_max = 0.1; // if more generations have extinctions or migrations, they are the rule and have no marks
const name_px = 5.8, name_gap_px = 14; // of a character of a name, and from the mark before a name to the next one
const name_characters_max = 28;
const name_line_px = 240; // a narrower line has no names

interface Mark {
  kind: string;
  generation: number;
  label: string;
  text: string;
}

export class TimeMarks {
  readonly labels = h("div", {class: "time-labels"});
  readonly marks = h("div", {class: "time-marks"});

  readonly #world: ViewedWorld;
  readonly #rebuild: () => void;
  #extinctions: number[] = []; // generations, oldest first
  /** How far #extinctions describes the history. */
  #scanned: {first: GenerationStatistics|undefined; island: number; generation: number}|null = null;
  #marks: Mark[] = []; // in order of their generations
  #texts: JoinedMark[] = [];
  readonly #seen: SeenEvents;
  #drawn = ""; // what labels and marks show
  #rebuilt_ms = -rebuild_ms;
  #timer = 0;

  /** rebuild: is called later if it is too early for a rebuild, and calls refresh(). */
  constructor(world: ViewedWorld, rebuild: () => void) {
    this.#world = world;
    this.#rebuild = rebuild;
    this.#seen = new SeenEvents(world);
  }

  close(): void {
    this.#seen.close();
    clearTimeout(this.#timer);
  }

  /** The texts of the marks near a position, which is 0 to 1. */
  texts_at(part: number, near: number): string[] {
    return this.#texts.filter((mark) => Math.abs(mark.part - part) <= near).flatMap(({texts}) => texts);
  }

  /** The texts of the marks of a generation. */
  texts_of(generation: number): string[] {
    return this.#marks.filter((mark) => mark.generation === generation).map(({text}) => text);
  }

  /** The nearest generation with a mark in this direction, 1 or -1; null: none. */
  next_generation(from: number, by: number): number|null {
    const beyond = this.#marks.map(({generation}) => generation).filter((one) => (one - from) * by > 0);
    return beyond.length === 0 ? null : by > 0 ? Math.min(...beyond) : Math.max(...beyond);
  }

  refresh(scale: TimeScale, width_px: number): void {
    const world = this.#world, {range: {first_generation, last_generation}, shown: {from, to}} = scale;
    this.#seen.refresh();
    const of_run = [world.name, world.island, first_generation, last_generation, from, to, this.#seen.all.length];
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
    const labelled = marked_generations(Math.ceil(from), Math.ceil(to) - 1, Math.floor(width_px / label_room_px));
    this.labels.replaceChildren(...labelled.map((generation) => {
      const label = h("span", {}, with_separators(generation));
      label.style.left = percent(scale.part_of(generation));
      return label;
    }));
    this.#collect(scale);
    this.#draw(scale, width_px);
  }

  #collect({range: {first_generation, last_generation}}: TimeScale): void {
    this.#scan_extinctions();
    const most = share_max * (last_generation - first_generation + 1), labels = timeline_texts.mark_labels;
    const changes = marks_of(this.#world.history.changes)
                      .map(({x, text, label}): Mark => ({kind: "change", generation: x, label, text}));
    const extinctions = this.#extinctions.map(
      (generation): Mark =>
        ({kind: "extinction", generation, label: labels.extinction, text: timeline_texts.extinction(generation)}));
    const seen = this.#seen.all, migrations = seen.filter(({kind}) => kind === "migration");
    const rare = [extinctions, migrations].filter((marks) => marks.length <= most).flat();
    this.#marks = [...changes, ...rare, ...seen.filter(({kind}) => kind !== "migration")]
                    .filter(({generation}) => generation >= first_generation && generation <= last_generation)
                    .sort((one, other) => one.generation - other.generation);
  }

  #draw(scale: TimeScale, width_px: number): void {
    const {from, to} = scale.shown, shown = this.#marks.filter(({generation: at}) => at >= from - 1 && at < to);
    const joined = joined_marks(shown.map((mark) => ({...mark, part: scale.part_of(mark.generation)})), mark_slots);
    this.#texts = joined;
    let free_px = -Infinity; // up to here the line is taken by marks and names
    const elements = joined.map(({part, texts, first}, i) => {
      const mark = h("i", {"data-kind": first.kind}), at = part * width_px, next = joined[i + 1];
      mark.style.left = percent(part);
      const name = texts.length > 1 ? timeline_texts.several(first.label, texts.length - 1) : first.label;
      const short = name.length > name_characters_max ? `${name.slice(0, name_characters_max - 1)}…` : name;
      const end = at + 7 + name_px * short.length, room = next === undefined ? width_px : next.part * width_px - 4;
      if (width_px >= name_line_px && at > free_px && part >= 0 && end <= room) {
        const text = h("span", {class: "time-name"}, short);
        text.style.left = percent(part);
        free_px = end + name_gap_px - 10;
        return [mark, text];
      }
      return [mark];
    });
    this.marks.replaceChildren(...elements.flat());
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
