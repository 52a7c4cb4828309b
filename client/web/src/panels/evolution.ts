// Evolution: shows generation 1 of the present world next to the present, and how the fitness has changed. A world in
// its first generations can run at full speed first.
//
// Owner    EvolutionButton; one. The live world keeps its pane; the replay gets the second one.
import type {Speed} from "../core/protocol";
import {evolution_texts as texts} from "../texts/evolution";
import type {Banner} from "../widgets/notices";
import type {EndedGeneration} from "../world/history";
import {run_or_pause_both, runs, why_not} from "../world/run_both";
import type {ViewedWorld} from "../world/world";
import type {SecondWorldContext} from "./second_world";

const early_max = 10; // generations in which there is little to see
const count = 30; // generations that a young world runs at full speed

export interface EvolutionContext extends SecondWorldContext {
  readonly panes: {
    readonly all: readonly unknown[]; close_second(): void;
    /** are_ordered: the second world is the past of the first one. */
    set_captions(text_of: (world: ViewedWorld) => string, are_ordered: boolean): void;
  };
}

/** A young world runs at full speed. */
interface Advance {
  world: ViewedWorld;
  from: number; // generation
  has_begun: boolean; // the server has answered
  ran: boolean; // before
  speed: Speed|undefined; // before
}

type State = {
  kind: "none"|"asks"
}|{kind: "runs", advance: Advance}|{kind: "shown", live: ViewedWorld, past: ViewedWorld};

export class Evolution {
  #state: State = {kind: "none"};
  readonly #context: EvolutionContext;
  readonly #on_change: () => void;

  /** on_change: called after banners() has changed. */
  constructor(context: EvolutionContext, on_change: () => void) {
    this.#context = context;
    this.#on_change = on_change;
  }

  get is_shown(): boolean {
    return this.#state.kind === "shown";
  }

  /** Shows generation 1 next to the present, or only the present again. */
  toggle(): void {
    if (this.#state.kind === "shown") {
      this.#context.panes.close_second();
    } else if (this.#state.kind !== "runs") {
      void this.#context.attempt(() => this.#begin());
    }
  }

  banners(): Banner[] {
    const state = this.#state, {server} = this.#context;
    const cancel = {label: texts.cancel, act: () => this.#cancel()};
    if (state.kind === "runs") {
      const {world, from} = state.advance, done = Math.min(Math.max(generation_of(world) - from, 0), count);
      const progress = {value: done, max: count};
      return [{name: "evolving", kind: "info", text: texts.runs(done, count), progress, actions: [cancel]}];
    }
    if (state.kind !== "asks") {
      return [];
    }
    const world = this.#context.world(), at_once = {label: texts.at_once, act: () => this.#show_now()};
    const run = {
      label: server.access.taking_part ? texts.run(count) : texts.take_part_and_run(count),
      act: () => this.#run_first()
    };
    const text = texts.asks(generation_of(world));
    const actions = server.access.may_take_part ? [run, at_once, cancel] : [at_once, cancel];
    return [{name: `evolution ${server.access.taking_part}`, kind: "info", text, actions}];
  }

  /** Shows the present state. */
  refresh(): void {
    const {panes} = this.#context, state = this.#state;
    if (state.kind === "shown" && !(panes.all.length > 1 && state.past.is_replay && !state.live.is_replay)) {
      const is_opening = panes.all.length > 1 && state.past.past.opening;
      this.#state = is_opening ? state : {kind: "none"};
    } else if (state.kind === "runs") {
      this.#advance(state.advance);
    }
    panes.set_captions((world) => this.#caption(world), this.is_shown);
  }

  async #begin(): Promise<void> {
    const {panes} = this.#context;
    if (panes.all.length > 1) {
      panes.close_second();
    }
    const world = this.#context.world();
    if (world.past.is_own_replay) {
      await world.past.back_to_live();
    }
    const generation = generation_of(world), is_over = world.control.state === "RUN_STATE_TERMINATED";
    if (generation <= early_max && !is_over) {
      this.#set({kind: "asks"});
    } else {
      await this.#show(world);
    }
  }

  #show_now(): void {
    void this.#context.attempt(() => this.#show(this.#context.world()));
  }

  #run_first(): void {
    const world = this.#context.world(), {server} = this.#context;
    if (!server.access.taking_part) {
      server.access.set_taking_part(true);
    }
    const from = generation_of(world), {speed} = world.control;
    const advance: Advance = {
      world,
      from,
      has_begun: false,
      ran: runs(world),
      speed: speed &&
        {
          ...speed
        }
    };
    this.#set({kind: "runs", advance});
    void this.#context.attempt(async () => {
      try {
        await world.control.set_speed({max: true});
        await world.control.run(count);
        advance.has_begun = true;
      } catch (error) {
        this.#set({kind: "none"});
        throw error;
      }
    });
  }

  /** Goes on when the generations have ended. */
  #advance({world, from, has_begun, speed}: Advance): void {
    const {state} = world.control;
    if (!has_begun || state === "RUN_STATE_RUNNING" || state === "RUN_STATE_UNSPECIFIED") {
      return;
    }
    this.#state = {kind: "none"};
    const is_done = state === "RUN_STATE_TERMINATED" || generation_of(world) >= from + count - 1;
    void this.#context.attempt(async () => {
      await world.control.set_speed(speed ?? {real_time_factor: 1});
      if (!is_done) {
        throw new Error(texts.interrupted);
      }
      await this.#show(world);
    });
    queueMicrotask(this.#on_change);
  }

  #cancel(): void {
    const state = this.#state;
    this.#set({kind: "none"});
    if (state.kind === "runs") {
      const {world, speed, ran} = state.advance;
      void this.#context.attempt(async () => {
        await world.control.set_speed(speed ?? {real_time_factor: 1});
        await (ran ? world.control.run() : world.control.pause());
      });
    }
  }

  async #show(live: ViewedWorld): Promise<void> {
    const past = this.#context.show_second(live.name, live.island), opening = past.past.show_nearest({generation: 1});
    this.#set({kind: "shown", live, past});
    try {
      await opening;
    } catch (error) {
      this.#context.panes.close_second();
      throw error;
    }
    const why = why_not(live);
    if (why !== "" && !runs(live)) {
      this.#context.notify(texts.stands(live.name, why));
      await past.control.pause_or_resume();
    } else if (!runs(live) || !runs(past)) {
      await (runs(live) ? past.control.pause_or_resume() : run_or_pause_both(this.#context));
    }
    this.#on_change();
  }

  /** What stands above a pane: the fitness then, and now. */
  #caption(world: ViewedWorld): string {
    if (this.#state.kind !== "shown") {
      return "";
    }
    const {live, past} = this.#state, history = live.history.generations.filter(({island}) => island === live.island);
    const first = history[0], last = history[history.length - 1];
    const text = (one: EndedGeneration): string =>
      texts.fitness(Number(one.fitness_mean ?? 0), Number(one.fitness_best ?? 0));
    if (world === past) {
      const generation = past.snapshot?.generation ?? 1, one = history.find((of) => of.generation === generation);
      return texts.then(generation, one === undefined ? texts.in_progress : text(one));
    }
    if (world !== live || first === undefined || last === undefined) {
      return "";
    }
    const factor = Number(last.fitness_mean ?? 0) / Number(first.fitness_mean ?? 0);
    const times = factor > 0 && Number.isFinite(factor) && last !== first ? texts.times(factor) : "";
    return texts.now(last.generation, text(last)) + times;
  }

  #set(state: State): void {
    this.#state = state;
    this.#on_change();
  }
}

function generation_of(world: ViewedWorld): number {
  return Math.max(world.info?.generation ?? 1, world.feed.newer_snapshot?.generation ?? 1);
}
