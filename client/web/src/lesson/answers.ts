// answers: how predictions compare with observations, and observations with laws. Pure functions.
import {value_at} from "./curve";
import {type Check, type Lesson, places_of, type Point, type Prediction, type Step} from "./lesson_file";
import type {Answer, Observed} from "./notes";

type Known = ReadonlyMap<string, Observed>;

/** The indices of the values, the largest value first; equal ones keep their order. */
export function order_of(values: readonly number[]): number[] {
  return values.map((_, i) => i).sort((a, b) => values[b]! - values[a]!);
}

/** How many pairs of options have another order in `one` than in `other`. */
export function pairs_in_wrong_order(one: readonly number[], other: readonly number[]): number {
  let count = 0;
  for (let i = 0; i < one.length; ++i) {
    for (let j = i + 1; j < one.length; ++j) {
      count += other.indexOf(one[i]!) > other.indexOf(one[j]!) ? 1 : 0;
    }
  }
  return count;
}

/** The root of the mean squared distance between a curve and values at places. */
export function distance(points: readonly Point[], places: readonly number[], values: readonly number[]): number {
  const squares = places.map((x, i) => (value_at(points, x) - values[i]!) ** 2);
  return Math.sqrt(squares.reduce((sum, square) => sum + square, 0) / places.length);
}

/** The numbers with these names; null if one has no value. */
function numbers(names: readonly string[], known: Known): number[]|null {
  const values = names.map((name) => known.get(name));
  return values.every((value): value is number => typeof value === "number") ? values : null;
}

/** What the check says about a prediction: nothing if an observation has no value. */
function result_of(check: Check, predicted: Prediction, lesson: Lesson, known: Known): Partial<Answer> {
  if ("near" in check) {
    const [observed] = numbers([check.near], known) ?? [];
    if (observed === undefined) {
      return {};
    }
    const apart = (predicted as number) - observed;
    const most = "within" in check ? check.within : check.within_percent / 100 * Math.abs(observed);
    return {observed, passed: Math.abs(apart) <= most, apart};
  }
  if ("order" in check) {
    const values = numbers(check.order, known);
    if (values === null) {
      return {};
    }
    const observed = order_of(values), apart = pairs_in_wrong_order(predicted as number[], observed);
    return {observed, passed: apart === 0, apart};
  }
  if ("curve" in check) {
    const values = known.get(check.curve);
    if (!Array.isArray(values) || values.length === 0 || values.some((value) => value === null)) {
      return {};
    }
    const apart = distance(predicted as Point[], places_of(lesson, check.curve), values as number[]);
    return {observed: values, passed: apart <= check.within, apart};
  }
  const values = numbers("argmax" in check ? check.argmax : check.argmin, known);
  if (values === null) {
    return {};
  }
  const observed = values.indexOf("argmax" in check ? Math.max(...values) : Math.min(...values));
  return {observed, passed: observed === predicted};
}

/** Compares the predictions with the observations after a step; null: the step compares nothing.
 *
 *  predictions  by id
 *  known        observations of this step and of earlier ones
 *  law          as it was computed */
export function answer_of(
  lesson: Lesson, step: Step, predictions: ReadonlyMap<string, Prediction>, known: Known,
  law: {value: number|null; error: number | null}|null): Answer|null {
  const {check} = step, id = check?.of ?? step.predict?.id;
  const of_law = law === null ? {} : {
    ...(law.value === null ? {} : {law: law.value}),
    ...(law.error === null ? {} : {error: law.error}),
  };
  if (check !== undefined && id !== undefined) {
    const predicted = predictions.get(id);
    return predicted === undefined ? null : {id, predicted, ...result_of(check, predicted, lesson, known), ...of_law};
  }
  if (step.law !== undefined) {
    const observed = known.get(step.law.of);
    return {id: step.law.of, ...(observed === undefined || observed === null ? {} : {observed}), ...of_law};
  }
  return null;
}
