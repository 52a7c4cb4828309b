// Tournament: the contestants and winners of the tournament that led to one pick. No DOM.
import type {BreedingRecord} from "./record";

export interface Contestant {
  organism: number;
  won: boolean;
  picked_now: boolean; // the pick shown selected this contestant
}

/** Returns the contestants of the tournament that led to pick `index`, in the order drawn. All winners are marked. If
 *  an organism was drawn several times, as many of its entries are marked as it has picks. Empty if the server sent no
 *  contestants. */
export function contestants_of(record: BreedingRecord, index: number): Contestant[] {
  const pick = record.picks[index];
  if (pick?.tournament === undefined) {
    return [];
  }
  const contestants: Contestant[] =
    (pick.contestants ?? []).map((organism) => ({organism, won: false, picked_now: false}));
  const same = (i: number): boolean => record.picks[i]?.tournament === pick.tournament;
  let first = index;
  while (first > 0 && same(first - 1)) {
    --first;
  }
  for (let i = first; same(i); ++i) {
    const winner =
      contestants.find((contestant) => !contestant.won && contestant.organism === (record.picks[i]!.organism ?? 0));
    if (winner) {
      winner.won = true;
      winner.picked_now = i === index;
    }
  }
  return contestants;
}
