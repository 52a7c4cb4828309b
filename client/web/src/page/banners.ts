// Banners of the page: what is wrong with the connection, the server, its disk or a link, and what the user can do.
import {app_texts} from "../texts/app";
import {storage_text} from "../texts/states";
import {session_text} from "../texts/users";
import type {Banner} from "../widgets/notices";
import type {Server} from "../world/server";
import type {Tokens} from "../world/tokens";
import type {EvolutionButton} from "./evolution_button";
import type {LinkFollower} from "./link_follower";

/** on_decline: called after the user has declined the token of a link. */
export function banners_of(
  server: Server, tokens: Tokens, link: LinkFollower, evolution: EvolutionButton, on_decline: () => void): Banner[] {
  return [
    ...of_connection(server), ...of_class(server), ...of_token(server, tokens, on_decline), ...link.banners(),
    ...of_storage(server), ...evolution.banners()
  ];
}

function of_connection(server: Server): Banner[] {
  const {phase, message} = server.state, banners: Banner[] = [];
  if (phase === "lost" || phase === "connecting") {
    banners.push(
      {name: "lost", kind: "bad", text: server.going_away ? app_texts.has_shut_down : app_texts.lost(message)});
  } else if (phase === "open" && server.going_away) {
    banners.push({name: "going", kind: "warn", text: app_texts.shuts_down});
  }
  if (server.updated) {
    const reload = {label: app_texts.reload, act: () => location.reload()};
    banners.push({name: "updated", kind: "warn", text: app_texts.updated, actions: [reload]});
  }
  return banners;
}

function of_class({access: {membership}, worlds}: Server): Banner[] {
  const is_frozen = membership !== null && worlds.all.some(({frozen}) => frozen);
  return is_frozen ? [{name: "frozen", kind: "warn", text: app_texts.frozen}] : [];
}

/** Asks whether to use the token of a link. */
function of_token(server: Server, tokens: Tokens, on_decline: () => void): Banner[] {
  const {offered} = tokens;
  if (offered === null || server.state.phase !== "open") {
    return [];
  }
  const use = {label: app_texts.use_token, act: () => server.connect(tokens.use(offered))};
  const keep = {
    label: app_texts.keep_token,
    act: () => {
      tokens.decline();
      on_decline();
    }
  };
  const text = app_texts.other_token(session_text(server.state.welcome));
  return [{name: "token", kind: "warn", text, actions: [use, keep]}];
}

function of_storage(server: Server): Banner[] {
  const text = storage_text(server.storage);
  return text === "" ? [] : [{name: "storage", kind: "bad", text}];
}
