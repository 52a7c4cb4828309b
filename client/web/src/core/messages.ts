// Messages between the page (main thread) and the worker, which owns the socket, the decoder and the canvases.
//
// All are plain objects that structured clone copies. A *pane* is one canvas with one shown world; panes are numbered
// from 0.
//
// protocol.ts describes the messages of the protocol.
import {event_kinds} from "./protocol";
import type {Event, EventKinds, Join, One, Request, RequestKinds, RequestRules, Response, Welcome} from "./protocol";
import type {Snapshot, SnapshotInfo} from "./snapshot";

export type RequestKind = keyof RequestKinds;
export type EventKind = keyof EventKinds;

/** What an event is about, for an exhaustive switch over `kind`; null: a kind that this page does not know. */
export function kind_of(event: Event): One<EventKinds>|null {
  const kind = event_kinds.find((known) => event[known] !== undefined);
  return kind === undefined ? null : {kind, value: event[kind]} as One<EventKinds>;
}

/** A union with one member for each field of Kinds: its fields, and its name as `kind`. */
export type Tagged<Kinds> = {
  [Kind in keyof Kinds]: {kind: Kind}&Kinds[Kind]
}[keyof Kinds];

/** For the end of a switch that has a case for every kind; the compiler refuses it if one is missing. */
export function none_left(_: never): void {}

export interface ConnectionState {
  phase: "connecting"|"open"|"lost"|"refused"; // lost: tries again by itself; refused: a user has to act
  message: string; // why, as a sentence; empty in "open"
  code: string; // "CODE_UNAUTHENTICATED" …; empty if there is none
  reason: string; // "REASON_CODE_UNKNOWN" …; empty if there is none
  silent_s: number; // the server has sent nothing for so long although a world runs; 0: it sends
  welcome: Welcome|null; // of the present or the last session
}

/** What the worker draws, and how. The panels change it through Pane.set_look(). */
export interface Look {
  skin: "vivid"|"classic";
  background: "dark"|"light";
  colour_by: string; // "" | "health" | "lineage" | name of a gene
  palette: "violet"|"viridis"|"cividis";
  trails: boolean;
  perception: "none"|"selected"|"all";
  forces: "none"|"selected"|"all";
  interpolate: boolean;
  flashes: boolean; // of meals and deaths
  density: boolean; // draws densities in place of organisms that are too many to see
  minimap: boolean; // while part of the island is out of sight
}

/** What a click on the island does. */
export type Tool = "select"|"food"|"poison"|"organism"|"remove";

/** What the renderer drew last, for legends and hints. */
export interface Drawing {
  shows: "nothing"|"organisms"|"dots"|"density";
  density: {cell_px: number; most: number}|null; // the colour scale of the densities is 0 to `most`
  health_max: number; // the upper end of the scale of health
  gene_range: [number, number]|null; // of the gene in look.colour_by
  lineages: {founder: number; count: number; colour: string}[]|null; // the largest lineages, largest first
  lineage_others: {lineages: number; count: number; placed: number}|null; // smaller lineages; placed by a user
  headings: boolean;
  predators: boolean; // the snapshot says which organisms are predators
  pointed_at: {organism: number|null; food: number | null; poison: number | null}|
    null; // food and poison: only for tools other than select
}

/** What the newest snapshot says about an island that is shown as a tile. */
export interface TileInfo {
  generation: number;
  alive: number;
  health_mean: number; // of the living organisms; 0 if there are none
}

/** A world on the wall of a class, and the place of its first island on the canvas, in CSS pixels. */
export interface WallTile {
  world: string;
  left: number;
  top: number;
  width: number;
  height: number;
}

/** The camera of a pane, in pixels of the island. */
export interface Camera {
  x_px: number; // the point in the middle of the pane
  y_px: number;
  zoom: number; // CSS pixels per px of the island
}

/** Columns about the current generation of the shown island, for colours, rings and arrows. Row i is organism id i. */
export interface PopulationColumns {
  generation: number;
  island: number;
  organism_count: number; // of the island; the columns may contain only the first ones
  gene_names: string[];
  genes: Float32Array[]; // one per gene
  fitness: Float64Array|null; // null: not known
  founders: Uint32Array|null;
  choices: Uint8Array|null;
  forces: Float32Array[]|null; // x, y
  targets: Float32Array[]|null; // x, y
}

interface MessagesToWorker {
  connect: {url: string; token: string; join: Join | null; descriptor: ArrayBuffer};
  request: {id: number; request: Request; first?: boolean}; // Request without request_id and client_key
  pane: {pane: number; canvas: OffscreenCanvas}; // transferred
  close_pane: {pane: number};
  resize: {pane: number; width: number; height: number; pixel_ratio: number}; // CSS pixels
  watch: {pane: number; world: string; island: number; rate_hz: number}; // subscribes; replaces the last watch
  unwatch: {pane: number};
  islands: {pane: number; islands: number}; // so many islands of the watched world as tiles; 0: only the watched one
  camera: {pane: number; camera: Camera | null}; // null: the whole island
  pointer: {pane: number; at: {x: number; y: number} | null; tool: Tool}; // CSS pixels in the canvas
  look: {pane: number; look: Look};
  select: {pane: number; organism: number | null; hovered: number | null; follow: boolean};
  population: {pane: number; columns: PopulationColumns | null};
  pick: {pane: number; id: number; x: number; y: number; radius: number}; // CSS pixels in the canvas
  wall: {canvas: OffscreenCanvas}; // transferred; the wall of a class
  wall_size: {width: number; height: number; pixel_ratio: number}; // CSS pixels
  wall_tiles: {tiles: WallTile[]; look: Look}; // subscribes to their worlds, and to no others
  close_wall: {};
  events_taken: {}; // the worker may send further events
  visible: {visible: boolean}; // document.visibilityState
  ask_columns: {pane: number; id: number}; // for tests: the entities of the drawn snapshot
  ask_figures: {id: number};
}

export type ToWorker = Tagged<MessagesToWorker>;

/** Figures for tests and benchmarks. The times are those of the last snapshots and frames that the worker remembers. */
export interface Figures {
  decode_p50_ms: number;
  decode_p95_ms: number;
  draw_p50_ms: number;
  draw_p95_ms: number;
  frames_per_s: number;
  snapshots: number;
  damaged_snapshots: number;
  reconnects: number;
  dropped: number; // snapshots that the server dropped
  heap_bytes: number; // 0: not known
}

/** What labels, lists and statistics show, all of one snapshot. It changes only a few times per second while the world
 *  runs, so that it can be read. */
export interface Reading {
  info: SnapshotInfo;
  healthiest: {id: number; health: number}[]; // the healthiest first
}

interface MessagesFromWorker {
  rules: {rules: Map<RequestKind, RequestRules>; roles: string[]}; // by the field of Request; roles in rising order
  state: {state: ConnectionState};
  response: {id: number; response: Response}; // refusals included
  failed: {id: number; message: string}; // no answer can arrive any more
  events: {events: Event[]}; // of all worlds. The page answers events_taken
  /** Of the drawn snapshot; at most 20 per second. */
  snapshot:
    {pane: number; info: SnapshotInfo; reading: Reading; selected: {x_px: number; y_px: number; health: number} | null};
  drawing: {pane: number; drawing: Drawing}; // after it has changed
  tiles: {pane: number; tiles: (TileInfo | null)[]}; // while all islands are shown; null: before the first snapshot
  watch_refused: {pane: number; message: string};
  camera: {pane: number; camera: Camera}; // the camera followed an organism
  /** Outside of the island x_px is -1. */
  picked: {
    id: number; generation: number; organism: number | null; food: number | null; poison: number | null; x_px: number;
    y_px: number
  };
  columns: {id: number; columns: Snapshot | null};
  figures: {id: number; figures: Figures};
}

export type FromWorker = Tagged<MessagesFromWorker>;
