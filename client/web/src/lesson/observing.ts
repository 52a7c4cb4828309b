// observing: the expressions of a step, with the numbers of earlier steps in them, and the answers to them. Pure.
import type {Step} from "./lesson_file";
import type {Observed} from "./notes";

/** What to ask, and to which value each answer belongs. */
export interface Asked {
  expressions: string[];
  law: boolean; // the last two expressions are the value and the error of the law
  /** For each observation its name, and for each of its values the index of the expression; null: it has no value. */
  places: {name: string; is_list: boolean; at: (number | null)[]}[];
}

export interface Values {
  observed: Map<string, Observed>;
  law: {value: number|null; error: number | null}|null;
}

/** Puts numbers in for names: "fitness_mean[20] / {before}". null: a name has no value. */
export function filled(expression: string, known: ReadonlyMap<string, Observed>): string|null {
  let is_complete = true;
  const text = expression.replace(/\{(\w+)\}/g, (_, name: string) => {
    const value = known.get(name);
    if (typeof value !== "number" || !Number.isFinite(value)) {
      is_complete = false;
      return "";
    }
    return `(${String(value).replace("e+", "e")})`;
  });
  return is_complete ? text : null;
}

/** known: the observations of earlier steps */
export function asked_by(step: Step, known: ReadonlyMap<string, Observed>): Asked {
  const expressions: string[] = [];
  const ask = (expression: string): number|null => {
    const text = filled(expression, known);
    return text === null ? null : expressions.push(text) - 1;
  };
  const places = Object.entries(step.observe ?? {}).map(([name, wanted]) => {
    if (typeof wanted === "string") {
      return {name, is_list: false, at: [ask(wanted)]};
    }
    return {name, is_list: true, at: wanted.at.map((x) => ask(wanted.each.replaceAll("{x}", String(x))))};
  });
  const value = filled(step.law?.value ?? "{}", known), error = filled(step.law?.error ?? "{}", known);
  const law = step.law !== undefined && value !== null && error !== null;
  if (law) {
    expressions.push(value, error);
  }
  return {expressions, law, places};
}

/** answers: one for each expression; undefined: it has no value */
export function values_of({places, law}: Asked, answers: readonly(number | undefined)[]): Values {
  const value_at = (i: number|null): number|null => (i === null ? null : answers[i] ?? null);
  const observed = places.map(({name, is_list, at}): [string, Observed] => {
    const values = at.map(value_at);
    return [name, is_list ? values : values[0] ?? null];
  });
  const [value = null, error = null] = law ? answers.slice(-2) : [];
  return {observed: new Map(observed), law: law ? {value, error} : null};
}
