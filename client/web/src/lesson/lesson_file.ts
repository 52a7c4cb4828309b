// lesson_file: the files of lessons, as docs/LESSONS.md describes them. The server has checked those that it sends.
import {language} from "../texts/language";

/** A line of the list of lessons. */
export interface ListedLesson {
  name: string;
  minutes: number;
  title: {en: string; de: string};
}

/** The value of a parameter in a lesson. */
export type Setting = number|boolean|string;

export interface Axis {
  label: string;
  min: number;
  max: number;
}

export type Point = [number, number];

interface Asked {
  id: string;
  ask: string;
}
export type NumberQuestion = Asked&{
  kind: "number";
  unit?: string;
  min: number;
  max: number
};
export type ChoiceQuestion = Asked&{
  kind: "choice";
  options: string[]
};
export type OrderQuestion = Asked&{
  kind: "order";
  options: string[]
};
export type CurveQuestion = Asked&{
  kind: "curve";
  x: Axis;
  y: Axis
};
export type SentenceQuestion = Asked&{kind: "sentence"};
export type Question = NumberQuestion|ChoiceQuestion|OrderQuestion|CurveQuestion|SentenceQuestion;

/** A prediction: a number, the index of a choice, the indices of an order, the points of a curve, or a sentence. */
export type Prediction = number|number[]|Point[]|string;

export type Check = {
  of?: string
}&({
  near: string;
  within: number
}|{
  near: string;
  within_percent: number
}|{argmax: string[]}|{argmin: string[]}|{order: string[]}|{
  curve: string;
  within: number
});

export interface Action {
  set?: {[parameter: string]: Setting};
  reset?: boolean;
  run?: number; // generations
}

export type Expression = string|{
  each: string;
  at: number[]
};

export interface Law {
  text: string;
  of: string; // the name of an observation
  value: string;
  error: string;
}

export interface Step {
  title: string;
  text: string;
  predict?: Question;
  do?: Action;
  observe?: {[name: string]: Expression};
  check?: Check;
  law?: Law;
}

export interface Lesson {
  title: string;
  minutes: number;
  goals: string[];
  needs: string;
  experiment: {[parameter: string]: Setting};
  seed: number;
  steps: Step[];
}

const folder = "lessons/";

async function read<Content>(file: string): Promise<Content> {
  const answer = await fetch(file);
  if (!answer.ok) {
    throw new Error(`${file}: ${answer.status} ${answer.statusText}`);
  }
  return await answer.json() as Content;
}

/** Loads the list of the lessons. Rejects with what is wrong. */
export async function load_list(): Promise<ListedLesson[]> {
  return (await read<{lessons: ListedLesson[]}>(`${folder}index.json`)).lessons;
}

/** Loads a lesson in the language of the page. Rejects with what is wrong. */
export function load_lesson(name: string): Promise<Lesson> {
  return read<Lesson>(`${folder}${language.folder}${encodeURIComponent(name)}.json`);
}

/** The question with an id; undefined: there is none. */
export function question_of(lesson: Lesson, id: string): Question|undefined {
  return lesson.steps.find(({predict}) => predict?.id === id)?.predict;
}

/** The places at which an observation with `each` is made; empty for others. */
export function places_of(lesson: Lesson, name: string): number[] {
  const found = lesson.steps.find(({observe}) => observe?.[name] !== undefined)?.observe?.[name];
  return found === undefined || typeof found === "string" ? [] : found.at;
}
