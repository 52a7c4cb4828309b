// Checks what the glass box makes of breedings of a real evod: glass_box_check.mjs FILE..., each with a serialised Breeding.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { bundle } from "../../unit/web/bundle.mjs";
import { schema } from "../../unit/web/support.mjs";

const breeding = await bundle("breeding");

function check_picks(record) {
  const comparison = breeding.compare(record), picks = record.pick_count;
  assert.ok(comparison !== null && picks > 0);
  assert.deepEqual(breeding.copies_after(record, picks), comparison.copies);
  assert.ok(comparison.deviations.every(Number.isFinite), "the law excludes a number of copies that was observed");
  const expected = comparison.expected.reduce((sum, copies) => sum + copies, 0);
  assert.ok(Math.abs(expected - picks) <= 1e-9 * picks, `${expected} copies are expected in ${picks} picks`);
  record.picks.forEach((pick, index) => {
    const { slot_begin = 0, slot_end = 0 } = record.contenders[pick.organism ?? 0];
    if (pick.turns !== undefined) {
      assert.ok(slot_begin <= pick.turns + 1e-12 && pick.turns <= slot_end + 1e-12, `pick ${index} is in another slot`);
    }
    const contestants = breeding.contestants_of(record, index);
    const rank = (contestant) => breeding.rank_of(record.contenders[contestant.organism]);
    if (pick.contestants !== undefined) {
      const winner = contestants.find((contestant) => contestant.picked_now);
      assert.ok(contestants.every((other) => other.won || rank(other) >= rank(winner)), `a loser of pick ${index} was fitter`);
    }
  });
}

/** Returns the number of changes by mutations and bounds. */
function check_descendants(record) {
  assert.equal(record.descendants.length, record.descendant_count);
  let changes = 0;
  for (const descendant of record.descendants) {
    const inheritance = breeding.inheritance_of(descendant);
    assert.deepEqual(inheritance?.genes, descendant.genes, `descendant ${descendant.id ?? 0}`);
    assert.ok(inheritance.changes.every((change) => change.after !== change.before));
    changes += inheritance.changes.length;
  }
  return changes;
}

for (const file of process.argv.slice(2)) {
  const page = schema.decode("evod.v1.Breeding", new Uint8Array(readFileSync(file)));
  const record = new breeding.BreedingRecord({ world: "w", run_id: "", island: 0, generation: Number(page.generation) });
  assert.ok(record.add(page));
  check_picks(record);
  assert.ok(check_descendants(record) > 0, "no gene was changed");
  const stepper = new breeding.Stepper();
  stepper.load(record.pick_count, record.descendant_count);
  for (let step = 0; step <= stepper.last_position; ++step, stepper.step()) {
    assert.doesNotMatch(breeding.caption(record, stepper.moment), /undefined|null|NaN/);
  }
}
