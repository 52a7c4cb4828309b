// experiment_text: the parameters of a world as the text of an experiment file. Pure functions.
import type {ParameterSet, ParameterValue} from "../core/protocol";

/** The text of an experiment file with the parameters and the schedule of a ParameterSet. */
export function experiment_json(set: ParameterSet): string {
  const value_of = (value: ParameterValue|undefined): unknown =>
    value?.real ?? value?.count ?? value?.flag ?? value?.choice;
  const experiment: {[name: string]: unknown} = {};
  for (const parameter of set.parameters ?? []) {
    const now = value_of(parameter.pending ?? parameter.value);
    const later = (set.schedule ?? []).filter((one) => one.name === parameter.name);
    experiment[parameter.name ?? ""] = later.length === 0 ?
      now :
      Object.fromEntries([["1", now], ...later.map((one) => [String(one.generation), value_of(one.value)])]);
  }
  return JSON.stringify(experiment, null, 2);
}
