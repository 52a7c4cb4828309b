// settings: the parameters that a lesson sets, and what changes by them. Pure functions.
import type {ParameterAssignment, ParameterDescription, ParameterSet, ParameterValue} from "../core/protocol";
import {same} from "../world/parameter_values";

import type {Setting} from "./lesson_file";

/** A parameter that a lesson sets. */
export interface SetParameter {
  about: ParameterDescription;
  before: ParameterValue; // at present
  after: ParameterValue;
}

function value_of(about: ParameterDescription, setting: Setting): ParameterValue {
  return typeof setting === "boolean"     ? {flag: setting} :
    typeof setting === "string"           ? {choice: setting} :
    about.kind === "PARAMETER_KIND_COUNT" ? {count: setting} :
                                            {real: setting};
}

/** The parameters that `settings` set, in the order of the registry.
 *
 *  all  also those that it does not name, to their defaults */
export function set_parameters(
  registry: readonly ParameterDescription[], set: ParameterSet, settings: {[name: string]: Setting},
  all = false): SetParameter[] {
  return registry.flatMap((about) => {
    const name = about.name ?? "", setting = settings[name];
    const state = set.parameters?.find((one) => one.name === name);
    if (state === undefined || (setting === undefined && !all)) {
      return [];
    }
    const after = setting === undefined ? about.default_value ?? {} : value_of(about, setting);
    return [{about, before: state.pending ?? state.value ?? {}, after}];
  });
}

export function changed(parameters: readonly SetParameter[]): SetParameter[] {
  return parameters.filter(({before, after}) => !same(before, after));
}

export function assignments(parameters: readonly SetParameter[]): ParameterAssignment[] {
  return parameters.map(({about, after}) => ({name: about.name ?? "", value: after}));
}
