// change_marks: changes of parameters as marks in plots over generations.
import type {AppliedChange} from "../core/protocol";
import {plot_texts} from "../texts/plot";
import {actor_text} from "../texts/users";
import {values_text} from "../world/change_text";
import type {Mark} from "./plot_layout";

/** Returns the marks of AppliedChange messages in a plot over generations. */
export function marks_of(changes: readonly AppliedChange[]): (Mark&{label: string})[] {
  return changes.map((change) => ({
                       x: change.generation ?? 0,
                       text: plot_texts.changed(change.generation ?? 0, values_text(change), actor_text(change.by)),
                       label: values_text(change),
                     }));
}
