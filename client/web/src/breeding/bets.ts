// Bets: the organisms that the user expects to be picked in a breeding, and the score of these bets. No DOM.
import {bet_texts} from "../texts/breeding_theory";
import type {Comparison} from "./comparison";

export const bets_max = 5;

export class Bets {
  /** In the order of the bets. */
  organisms: number[] = [];

  /** Places a bet on the organism, or withdraws it. Ignores further bets after bets_max. */
  toggle(organism: number): void {
    if (this.has(organism)) {
      this.organisms = this.organisms.filter((other) => other !== organism);
    } else if (this.organisms.length < bets_max) {
      this.organisms.push(organism);
    }
  }

  has(organism: number): boolean {
    return this.organisms.includes(organism);
  }
}

/** The result of bets after some picks. One pick of an organism with a bet is one hit. */
export interface BetScore {
  bets: number;
  picks: number;
  hits: number;
  random: number; // expected hits of as many bets on organisms drawn at random, for the picks that were made
  law: number; // expected hits of these bets by the law of the selection method, for all picks
  most: number; // most hits that this number of bets could have had
}

/** copies  copies of each rank in the first `picks` picks */
export function score_of(bets: Bets, comparison: Comparison, copies: readonly number[], picks: number): BetScore {
  const count = bets.organisms.length;
  const score: BetScore =
    {bets: count, picks, hits: 0, random: copies.length > 0 ? count * picks / copies.length : 0, law: 0, most: 0};
  copies.forEach((number, rank) => {
    if (bets.has(comparison.organisms[rank]!)) {
      score.hits += number;
      score.law += comparison.expected[rank]!;
    }
  });
  score.most = [...copies].sort((a, b) => b - a).slice(0, count).reduce((sum, number) => sum + number, 0);
  return score;
}

/** "4 of 25 picks hit your 5 bets. Random bets: 2.5 expected. …"
 *
 *  complete  whether all picks were made; otherwise the text does not contain the law and the best possible bets */
export function score_text(score: BetScore, complete: boolean): string {
  return bet_texts.hits(score.hits, score.picks, score.bets, score.random) +
    (complete ? bet_texts.result(score.law, score.most, score.random > 0 ? score.hits / score.random : null) : "");
}
