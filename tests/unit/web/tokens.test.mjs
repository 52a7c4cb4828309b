// The token with which the page connects.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const { Tokens } = await bundle("world/tokens");

/** The tokens of a page in a tab that has stored a token. */
function tokens_with(stored) {
  const tab = { stored };
  const store = { get: () => tab.stored, set: (_key, token) => { tab.stored = token; } };
  return { tab, tokens: new Tokens(store) };
}

test("the first link brings the token", () => {
  const { tab, tokens } = tokens_with("");
  assert.equal(tokens.begin("a"), "a");
  assert.deepEqual([tokens.offered, tab.stored], [null, "a"]);
  assert.equal(tokens_with("a").tokens.begin(null), "a");
  assert.equal(tokens_with("").tokens.begin(null), "");
});

test("another link does not replace a token that works", () => {
  const { tab, tokens } = tokens_with("mine");
  assert.equal(tokens.begin("theirs"), "mine");
  tokens.opened();
  assert.deepEqual([tokens.offered, tab.stored], ["theirs", "mine"]);
  tokens.decline();
  assert.deepEqual([tokens.offered, tokens.used], [null, "mine"]);
  assert.equal(tokens.follow("theirs"), null);
  assert.equal(tokens.use(tokens.offered), "theirs");
  tokens.opened();
  assert.deepEqual([tokens.offered, tab.stored], [null, "theirs"]);
  assert.equal(tokens.follow("theirs"), null);
  assert.equal(tokens.offered, null);
});

test("another link replaces a token that is refused", () => {
  const { tab, tokens } = tokens_with("revoked");
  assert.equal(tokens.begin("new"), "revoked");
  assert.equal(tokens.refused(), "new");
  tokens.opened();
  assert.equal(tab.stored, "new");
  assert.equal(tokens.refused(), null); // revoked later
  assert.equal(tab.stored, "");
  assert.equal(tokens.follow("newer"), "newer");
});

test("a refused token of a link gives way to the one before", () => {
  const { tab, tokens } = tokens_with("");
  assert.equal(tokens.begin(null), ""); // the server needs none
  tokens.opened();
  assert.equal(tokens.follow("wrong"), null);
  tokens.use(tokens.offered);
  assert.equal(tokens.refused(), "");
  tokens.opened();
  assert.equal(tab.stored, "");
});

test("the token of a new member is kept for the tab", () => {
  const { tab, tokens } = tokens_with("");
  tokens.opened("member");
  assert.deepEqual([tokens.used, tab.stored], ["member", "member"]);
  tokens.opened("");
  assert.equal(tokens.used, "member");
});

test("a refused token is not kept for the tab", () => {
  const { tab, tokens } = tokens_with("");
  assert.equal(tokens.begin("wrong"), "wrong");
  assert.equal(tokens.refused(), null);
  assert.deepEqual([tab.stored, tokens.used], ["", "wrong"]);
  assert.equal(tokens.use(""), ""); // the form
  tokens.opened();
  assert.equal(tab.stored, "");
});
