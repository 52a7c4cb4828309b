// event_text: events as sentences, and which of them a user should notice at once.
//
// proto/texts/events.json contains the templates, and server/protocol/event_text.h describes them. This file fills them
// in as the server does; proto/vectors/events.json contains examples, which the tests of both compare. The templates of
// other languages are in folders next to events.json, and also have the rules parameter, choice and allowed. The page
// fills in the events itself, because it creates events_dropped itself, too.
import texts from "../../../../proto/texts/events.json";
import {capitalised, localised, plain_fitness, with_separators} from "../texts/numbers";
import {allowed_words, choice_labels, parameter_labels} from "../texts/registry";
import {type EventKind, kind_of, type RequestKind} from "../core/messages";
import type {Event} from "../core/protocol";

type Words = {
  readonly [name: string]: string
};
const templates: {readonly [name: string]: string|Words} = texts;
const template_of_kind: {readonly[kind in EventKind]: string} = texts; // the compiler knows if one is missing

/** The events of which users of a world want to hear, and the commands that cause them. */
export const noticed_events: {readonly[kind in EventKind]?: readonly RequestKind[]} = {
  parameters_changed: ["set_parameters"],
  change_planned: ["set_parameters"],
  change_cancelled: ["cancel_change"],
  change_dropped: [],
  world_reset: ["reset_world"],
  world_deleted: ["delete_world"],
  world_damaged: [],
  run_terminated: [],
};

/** Events about the progress of the simulation. */
const progress: ReadonlySet<EventKind> =
  new Set(["generation_finished", "migration", "extinction", "fitness_awaited"] as const);

/** The sentence about an event, and whether it is about the progress of the simulation. */
export function event_text(event: Event): [string, boolean] {
  const about = kind_of(event);
  return about === null ?
    [event.text ?? "", false] :
    [capitalised(fill(template_of_kind[about.kind], about.value, event).text), progress.has(about.kind)];
}

/** A text, and whether all values in it are present. */
interface Filled {
  text: string;
  present: boolean;
}

function fill(template: string, message: unknown, event: Event): Filled {
  const filled = {text: "", present: true};
  for (const [, plain, argument, alternatives] of template.matchAll(/([^[{]+)|\{(.*?)\}|\[(.*?)\]/g)) {
    if (argument !== undefined) {
      const {text, present} = fill_argument(argument, message, event);
      filled.text += text;
      filled.present &&= present;
    } else {
      filled.text += plain ??
        alternatives!.split("|").map((one) => fill(one, message, event)).find((one) => one.present)?.text ?? "";
    }
  }
  return filled;
}

/** Fills in the text between braces. */
function fill_argument(argument: string, message: unknown, event: Event): Filled {
  const parts = argument.split("; ").map((part): Filled => {
    const [path = "", rule = ""] = part.split(":"), fields = path.split("."), of_event = fields[0] === "event";
    return text_of_all(values_of(of_event ? event : message, of_event ? fields.slice(1) : fields), rule, event);
  });
  const present = parts.filter((part) => part.present);
  return parts.length === 1 ? parts[0]! :
                              {text: present.map((part) => part.text).join(", "), present: present.length > 0};
}

/** The values of a path: one, undefined if its field is absent; or all of a repeated field. */
function values_of(value: unknown, fields: string[]): unknown[] {
  if (Array.isArray(value)) {
    return value.flatMap((one) => values_of(one, fields));
  }
  const [first, ...rest] = fields;
  return first === undefined ? [value] : values_of((value as {[field: string]: unknown} | undefined)?.[first], rest);
}

function text_of_all(values: unknown[], rule: string, event: Event): Filled {
  const [kind = "", words] =
    [rule.split(" ", 1)[0], rule.includes(" ") ? rule.slice(rule.indexOf(" ") + 1) : undefined];
  const given = values.filter((value) => value !== undefined), any_given = given.length > 0;
  switch (kind) {
    case "count":
      return amount(BigInt(given.length), words);
    case "sum":
      return amount(given.reduce((sum: bigint, value) => sum + whole(value), 0n), words);
    case "max":
      return {text: localised(plain_fitness(values.length ? Math.max(...values.map(number)) : 0)), present: any_given};
    case "mean":
      return {
        text: localised(plain_fitness(values.reduce((sum: number, value) => sum + number(value) / values.length, 0))),
        present: any_given
      };
    case "if":
      return {text: "", present: any_given};
    case "first":
      return {text: any_given ? text_of(given[0], "", event) : "", present: any_given};
    default: {
      const text = values.map((value) => text_of(value, rule, event)).filter(Boolean).join(", ");
      return {text, present: rule === "" || rule === "real" ? any_given : text !== ""};
    }
  }
}

/** An absent value counts as 0, as in the protocol. */
function number(value: unknown): number {
  return Number(value ?? 0);
}

function whole(value: unknown): bigint {
  return typeof value === "bigint" ? value : BigInt(number(value));
}

/** The text of one value by a rule that treats each value on its own. */
function text_of(value: unknown, rule: string, event: Event): string {
  switch (rule) {
    case "":
      return with_separators(typeof value === "string" ? value : whole(value));
    case "text":
      return value === undefined ? "" : String(value);
    case "parameter":
      return parameter_labels[String(value)] ?? String(value ?? "");
    case "choice":
      return choice_labels[String(value)] ?? String(value ?? "");
    case "allowed":
      return allowed_words(String(value ?? ""));
    case "real":
      return localised(real_text(number(value)));
    default: {
      const named = templates[rule]!;
      return value === undefined  ? "" :
        typeof named === "string" ? fill(named, value, event).text :
                                    named[String(value)] ?? "";
    }
  }
}

/** "3 organisms"; without words, only the number. */
function amount(number: bigint, words: string|undefined): Filled {
  const text = with_separators(number);
  return {
    text: words === undefined ? text : `${text} ${words.split("/")[number === 1n ? 0 : 1]}`,
    present: number !== 0n
  };
}

function real_text(number: number): string {
  const size = Math.abs(number);
  return size === 0 || (size >= 1e-5 && size < 1e15) ? String(number + 0) :
                                                       number.toExponential().replace(/e([+-])(\d)$/, "e$10$2");
}
