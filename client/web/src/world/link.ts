// link: the link to a moment of a world: "#world=default&generation=12&tick=600&island=0&organism=7".
// client/core/page_link.h and client/python/evod/page_link.py define the same form. Pure functions.
import {link_texts} from "../texts/link";
import type {Moment} from "./time_scale";

/** What a link shows. null: the link does not say. */
export interface PageMoment {
  world: string|null;
  generation: number|null; // null: the world as it runs
  tick: number|null; // since the generation began
  island: number|null;
  organism: number|null;
  rate: number|null; // snapshots per second
}

export interface ReadLink {
  moment: PageMoment;
  got: {[field: string]: string}; // the numbers as the link spells them
  wrong: string[]; // sentences about fields that are not numbers
}

const numbers = ["generation", "tick", "island", "organism", "rate"] as const;
export type LinkNumber = typeof numbers[number];

/** Never contains a token. */
export function link_of(page: string, moment: PageMoment): string {
  const {world, generation, organism, rate} = moment;
  const island = moment.island ?? (organism === null ? null : 0), tick = generation === null ? null : moment.tick ?? 0;
  const fields = Object.entries({world, generation, tick, island, organism, rate});
  return `${page}#${fields.filter(([, value]) => value !== null).map(([name, value]) => `${name}=${value}`).join("&")}`;
}

/** Reads location.hash. Returns null if it contains no field of a link. */
export function read_link(hash: string): ReadLink|null {
  const fields = new URLSearchParams(hash.replace(/^#/, ""));
  const world = fields.get("world");
  const moment: PageMoment = {world, generation: null, tick: null, island: null, organism: null, rate: null};
  const got: {[field: string]: string} = {}, wrong: string[] = [];
  for (const name of numbers) {
    const text = fields.get(name)?.trim();
    if (text === undefined) {
      continue;
    }
    const number = text === "" ? NaN : Number(text); // also "9e9"
    if (Number.isInteger(number)) {
      moment[name] = Math.min(Math.max(number, 0), Number.MAX_SAFE_INTEGER);
      got[name] = text;
    } else {
      wrong.push(link_texts.no_number(name, text));
    }
  }
  if (moment.tick !== null && moment.generation === null) {
    moment.tick = null;
    if (!fields.has("generation")) {
      wrong.push(link_texts.tick_alone(got.tick ?? ""));
    }
  }
  return moment.world === null && Object.keys(got).length === 0 && wrong.length === 0 ? null : {moment, got, wrong};
}

/** "island: got 7, world default has 0 to 3" */
export function wrong_number(read: ReadLink, name: LinkNumber, subject: string, first: number, last: number): string {
  return link_texts.out_of_range(name, read.got[name] ?? read.moment[name] ?? "", subject, first, last);
}

/** A number within a range. Adds a sentence to `read.wrong` if the link asks for one outside. */
export function within(read: ReadLink, name: LinkNumber, subject: string, first: number, last: number): number|null {
  const number = read.moment[name];
  if (number === null || (number >= first && number <= last && Number(read.got[name] ?? number) >= 0)) {
    return number;
  }
  read.wrong.push(wrong_number(read, name, subject, first, last));
  return Math.min(Math.max(number, first), last);
}

/** Returns the nearest moment after the server has refused one, and adds a sentence to `read.wrong`; null if the
 *  refusal is about something else.
 *
 *  field    "open_replay.at.tick"
 *  allowed  "0 to 2400 in generation 12", as in the refusal
 *  returns  {} for the last moment of the run. */
export function nearest(read: ReadLink, wanted: Moment, field: string, allowed: string): Moment|null {
  const name = field.slice(field.lastIndexOf(".") + 1), range = /^(\d+)(?: to (\d+))?/.exec(allowed);
  if (!range || (name !== "generation" && name !== "tick") || wanted[name] === undefined) {
    return null;
  }
  const first = Number(range[1]), last = Number(range[2] ?? range[1]);
  if (name === "tick") {
    read.wrong.push(wrong_number(read, name, link_texts.generation(wanted.generation ?? 0), first, last));
    return {generation: wanted.generation, tick: Math.min(Math.max(wanted.tick!, first), last)};
  }
  read.wrong.push(wrong_number(read, name, link_texts.run, first, last));
  return wanted.generation! > last ? {} : {generation: first};
}
