// Spot: an organism in a family tree, and the tree. No DOM.
import type {Ancestor} from "./lineage";

export interface Spot {
  ancestor: Ancestor;
  x: number; // from 0 to FamilyTree.width
  first: number; // places of the parents in the row above; -1: unknown, or not in the tree
  second: number;
}

export interface FamilyTree {
  first_generation: number; // of the first row
  rows: Spot[][]; // ordered by x
  width: number;
}

/** A place in the tree. */
export interface Place {
  row: number;
  place: number;
}
