// event_text: events as sentences, and which of them a user should notice at once.
import {duration, with_separators} from "../texts/numbers";
import {actor_text, outcome_words, speed_text, state_word, storage_text} from "../texts/texts";

import {change_value_text} from "./change_text";

import type {Message} from "../core/messages";

/** The commands that cause the events of which users of a world want to hear. */
export const noticed_events: {[event: string]: string[]} = {
  parameters_changed: ["set_parameters"],
  change_planned: ["set_parameters"],
  change_cancelled: ["cancel_change"],
  change_dropped: [],
  world_reset: ["reset_world"],
  world_deleted: ["delete_world"],
  world_damaged: [],
  run_terminated: [],
};

function list(names: string[]): string {
  return names.join(", ");
}

function entities(verb: string, placed: Message): string {
  const parts =
    ([["food", "food", "food"], ["poison", "poison", "poison"], ["organisms", "organism", "organisms"]] as const)
      .map(([field, one, many]) => [placed[field]?.length ?? 0, one, many] as const)
      .filter(([count]) => count > 0)
      .map(([count, one, many]) => `${count} ${count === 1 ? one : many}`);
  return `${actor_text(placed.by)} ${verb} ${parts.join(", ")}${placed.island ? ` on island ${placed.island}` : ""}`;
}

function when(change: Message|undefined): string {
  return change?.tick !== undefined ? `after tick ${with_separators(change.tick)}` :
                                      `from generation ${with_separators(change?.generation ?? 0)}`;
}

/** The sentence about an event, and whether it is about the progress of the simulation. */
export function event_text(event: Message): [string, boolean] {
  if (event.generation_finished) {
    const of: Message|undefined = event.generation_finished.statistics?.[0];
    return [
      `Generation ${with_separators(of?.generation ?? 0)} has ended after ${
        duration(of?.simulated_s ?? 0)}: best fitness ${(of?.fitness_best ?? 0).toFixed(1)}, mean ${
        (of?.fitness_mean ?? 0).toFixed(1)}`,
      true
    ];
  }
  if (event.migration) {
    const edges: Message[] = event.migration.edges ?? [];
    return [
      `${edges.reduce((sum, edge) => sum + (edge.migrant_count ?? 0), 0)} organisms migrated over ${edges.length} ${
        edges.length === 1 ? "edge" : "edges"}`,
      true
    ];
  }
  if (event.extinction) {
    return [
      `All organisms of island ${event.extinction.island ?? 0} have died in generation ${
        with_separators(event.extinction.generation ?? 0)}`,
      true
    ];
  }
  if (event.fitness_awaited) {
    return [
      `The world waits for the fitness of generation ${with_separators(event.fitness_awaited.generation ?? 0)}`, true
    ];
  }
  const sentence = sentence_of(event);
  return [sentence.charAt(0).toUpperCase() + sentence.slice(1), false];
}

function sentence_of(event: Message): string {
  if (event.parameters_changed) {
    const {by, changed = []} = event.parameters_changed;
    return `${actor_text(by)} changed ${
      list(changed.map((one: Message) => `${one.name} to ${change_value_text(one.pending ?? one.value)}`))}`;
  }
  if (event.change_planned) {
    const {change} = event.change_planned;
    return `${actor_text(change?.by)} plans to change ${
      list((change?.parameters ?? []).map((one: Message) => one.name))} ${when(change)}`;
  }
  if (event.change_cancelled) {
    const {by, change} = event.change_cancelled;
    return `${actor_text(by)} cancelled the change of ${
      list((change?.parameters ?? []).map((one: Message) => one.name))} ${when(change)}`;
  }
  if (event.change_dropped) {
    return `the change of ${list(event.change_dropped.name ?? [])} that ${
      actor_text(event.change_dropped.by)} planned was dropped, because it conflicts with the other parameters`;
  }
  if (event.run_control_changed) {
    const {by, world} = event.run_control_changed;
    return `${actor_text(by)}: the world is ${state_word(world?.state ?? "")}, speed ${speed_text(world?.speed)}`;
  }
  if (event.run_terminated) {
    return `the run has ended: ${outcome_words(event.run_terminated.outcome)}`;
  }
  if (event.world_created) {
    return `${actor_text(event.world_created.by)} created the world ${event.world ?? ""}`;
  }
  if (event.world_reset) {
    return `${actor_text(event.world_reset.by)} reset the world`;
  }
  if (event.world_deleted) {
    return `${actor_text(event.world_deleted.by)} deleted the world ${event.world ?? ""}`;
  }
  if (event.world_damaged) {
    return `the world ${event.world ?? ""} does not run: ${event.world_damaged.reason ?? ""}`;
  }
  if (event.placed) {
    return entities("placed", event.placed);
  }
  if (event.removed) {
    return entities("removed", event.removed);
  }
  if (event.fitness_set) {
    return `${actor_text(event.fitness_set.by)} set the fitness of ${
      with_separators(
        event.fitness_set.organism_count ??
        0)} organisms of generation ${with_separators(event.fitness_set.generation ?? 0)}`;
  }
  if (event.storage_changed) {
    const of = event.world ? `the world ${event.world}: ` : "";
    return of +
      (storage_text(event.storage_changed.storage) ||
       (of ? "its run file can be written again" : "the server can write its runs again"));
  }
  if (event.server_going_away) {
    return "the server is shutting down";
  }
  if (event.events_dropped) {
    return event.events_dropped.dropped_count ?
      `${with_separators(event.events_dropped.dropped_count)} events were dropped: this page read too slowly` :
      "events may be missing: the connection was lost meanwhile";
  }
  return "";
}
