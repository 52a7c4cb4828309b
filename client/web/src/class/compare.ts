// compare: what the worlds of a class have in common and where they differ. Pure functions.
import type {CreateWorld, ParameterDescription, ParameterSet, ParameterValue} from "../core/protocol";
import {same} from "../world/parameter_values";

/** The parameters of one world, in effect or, if a change is pending, as requested. */
export type Values = ReadonlyMap<string, ParameterValue>;

export function values_of(set: ParameterSet): Values {
  return new Map((set.parameters ?? []).map(({name = "", value = {}, pending}) => [name, pending ?? value]));
}

/** The parameters with which the worlds of a class begin; null: the text of the experiment cannot be read. */
export function start_of(
  {parameters = [], experiment_json = ""}: CreateWorld, registry: readonly ParameterDescription[]): Values|null {
  let experiment: {[name: string]: unknown} = {};
  try {
    experiment = experiment_json === "" ? {} : JSON.parse(experiment_json);
  } catch {
    return null;
  }
  const given = (about: ParameterDescription): ParameterValue => {
    const value = experiment[about.name ?? ""];
    const first = typeof value === "object" && value !== null ? (value as {[generation: string]: unknown})["1"] : value;
    return typeof first === "number" ? (about.kind === "PARAMETER_KIND_COUNT" ? {count: first} : {real: first}) :
      typeof first === "boolean"     ? {flag: first} :
      typeof first === "string"      ? {choice: first} :
                                       about.default_value ?? {};
  };
  const values = new Map(registry.map((about) => [about.name ?? "", given(about)]));
  for (const {name = "", value = {}} of parameters) {
    values.set(name, value);
  }
  return values;
}

/** The names of the parameters that are not equal in all worlds, in the order of the first world. */
export function differing(worlds: readonly Values[]): string[] {
  const [first, ...others] = worlds;
  return [...first?.keys() ?? []].filter(
    (name) => others.some((other) => !same(other.get(name) ?? {}, first!.get(name) ?? {})));
}

/** The names of the parameters in which a world differs from the start. */
export function changed_since(start: Values, now: Values): string[] {
  return [...now.keys()].filter((name) => start.has(name) && !same(start.get(name)!, now.get(name)!));
}

export interface Group<Of> {
  value: ParameterValue;
  members: Of[];
}

/** Groups by the value of a parameter: numbers in rising order, others in the order in which they appear. */
export function grouped_by<Of extends {values: Values}>(members: readonly Of[], parameter: string): Group<Of>[] {
  const groups: Group<Of>[] = [];
  for (const member of members) {
    const value = member.values.get(parameter) ?? {}, group = groups.find((one) => same(one.value, value));
    if (group) {
      group.members.push(member);
    } else {
      groups.push({value, members: [member]});
    }
  }
  const number = ({value: {real, count}}: Group<Of>): number => real ?? count ?? 0;
  return groups.sort((one, other) => number(one) - number(other));
}

/** A curve: y[i] belongs to the generation x[i], which rises. */
export interface Curve {
  x: readonly number[];
  y: readonly number[];
}

/** The median of several curves, in each generation that any of them has. */
export function median_of(curves: readonly Curve[]): Curve {
  const at = new Map<number, number[]>();
  for (const {x, y} of curves) {
    x.forEach((generation, i) => {
      if (Number.isFinite(y[i]!)) {
        at.set(generation, [...at.get(generation) ?? [], y[i]!]);
      }
    });
  }
  const x = [...at.keys()].sort((one, other) => one - other);
  return {x, y: x.map((generation) => median(at.get(generation)!))};
}

export function median(numbers: readonly number[]): number {
  const sorted = [...numbers].sort((one, other) => one - other), middle = sorted.length >> 1;
  return sorted.length % 2 === 1 ? sorted[middle]! : (sorted[middle - 1]! + sorted[middle]!) / 2;
}
