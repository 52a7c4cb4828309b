// Texts about parameters in place of those that the server sends. They are English, so there are none here.
interface Words {
  readonly [name: string]: string|undefined;
}

/** By topic: "food_and_poison". */
export const topic_titles: Words = {};
export const parameter_labels: Words = {};
export const parameter_helps: Words = {};
export const choice_labels: Words = {};
/** By parameter and choice: "selection roulette". */
export const choice_helps: Words = {};
export const unit_words: Words = {};
/** Units after the number 1. */
export const unit_words_of_one: Words = {};

/** What a refusal allows, as the server writes it: "0 to 1". */
export function allowed_words(allowed: string): string {
  return allowed;
}
