// Messages between the page (main thread) and the worker, which owns the socket, the decoder and the canvases.
//
// All are plain objects that structured clone copies. A *pane* is one canvas with one shown world; panes are numbered from 0.
import type {SnapshotInfo} from "./snapshot";

/** A protobuf message: keys are the field names of the .proto files; absent fields are missing; repeated fields are arrays
 *  (missing: empty); enums are their names; 64-bit integers are numbers, or bigint beyond 2^53; bytes are Uint8Array. */
export type Message = {
  [field: string]: any
};

export interface ConnectionState {
  phase: "connecting"|"open"|"lost"|"refused"; // lost: tries again by itself; refused: a user has to act
  message: string; // why, as a sentence; empty in "open"
  code: string; // "CODE_UNAUTHENTICATED" …; empty if there is none
  welcome: Message|null; // session.proto Welcome of the present or the last session
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
  renderer: "webgl2"|"canvas2d";
  shows: "nothing"|"organisms"|"dots"|"density";
  density: {cell_px: number; most: number}|null; // the colour scale of the densities is 0 to `most`
  health_max: number; // the upper end of the scale of health
  gene_range: [number, number]|null; // of the gene in look.colour_by
  lineages: {founder: number; count: number; colour: string}[]|null; // the largest lineages, largest first
  lineage_others: {lineages: number; count: number; placed: number}|null; // smaller lineages; placed by a user
  headings: boolean;
  pointed_at: {organism: number|null; food: number | null; poison: number | null}|
    null; // food and poison: only for tools other than select
}

/** What the newest snapshot says about an island that is shown as a tile. */
export interface TileInfo {
  generation: number;
  alive: number;
  health_mean: number; // of the living organisms; 0 if there are none
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
  gene_names: string[];
  genes: Float32Array[]; // one per gene
  founders: Uint32Array|null;
  choices: Uint8Array|null;
  forces: Float32Array[]|null; // x, y
  targets: Float32Array[]|null; // x, y
}

export type ToWorker =|{
  kind: "connect";
  url: string;
  token: string;
  descriptor: ArrayBuffer
}
|{
  kind: "request";
  id: number;
  request: Message;
  first?: boolean
} // Request without request_id and client_key
|{
  kind: "pane";
  pane: number;
  canvas: OffscreenCanvas
} // transferred
|{
  kind: "close_pane";
  pane: number
}
|{
  kind: "resize";
  pane: number;
  width: number;
  height: number;
  pixel_ratio: number
} // CSS pixels
|{
  kind: "watch";
  pane: number;
  world: string;
  island: number;
  rate_hz: number
} // subscribes; replaces the last watch
|{
  kind: "unwatch";
  pane: number
}
|{
  kind: "islands";
  pane: number;
  islands: number
} // shows so many islands of the watched world as tiles; 0: only the watched island
|{
  kind: "camera";
  pane: number;
  camera: Camera|null
} // null: the whole island
|{
  kind: "pointer";
  pane: number;
  at: {x: number; y: number}|null;
  tool: Tool
} // CSS pixels in the canvas
|{
  kind: "look";
  pane: number;
  look: Look
}
|{
  kind: "select";
  pane: number;
  organism: number|null;
  hovered: number|null;
  follow: boolean
}
|{
  kind: "population";
  pane: number;
  columns: PopulationColumns|null
}
|{
  kind: "pick";
  pane: number;
  id: number;
  x: number;
  y: number;
  radius: number
} // CSS pixels in the canvas
|{kind: "events_taken"} // the worker may send further events
|{
  kind: "visible";
  visible: boolean
} // document.visibilityState
|{
  kind: "ask_columns";
  pane: number;
  id: number
} // for tests: the entities of the drawn snapshot
|{
  kind: "ask_figures";
  id: number
};

/** What the option (evod.v1.rules) of the protocol says about one kind of request. */
export interface RequestRules {
  kind: string; // "REQUEST_KIND_COMMAND"
  role: string; // "ROLE_VIEWER": the lowest role that may send the request
  viewer_in_own_replay: boolean; // a viewer may send it if `world` is a replay of this session
  answer: string; // the field of Response that an accepted request sets; empty: none
}

export type FromWorker =|{
  kind: "rules";
  rules: Map<string, RequestRules>;
  roles: string[]
} // by the field of Request; roles in rising order
|{
  kind: "state";
  state: ConnectionState
}
|{
  kind: "response";
  id: number;
  response: Message
} // commands.proto Response, refusals included
|{
  kind: "failed";
  id: number;
  message: string
} // no answer can arrive any more
|{
  kind: "events";
  events: Message[]
} // stream.proto Event; of all worlds. The page answers events_taken
|{
  kind: "snapshot";
  pane: number;
  info: SnapshotInfo;
  healthiest: {id: number; health: number}[];
  selected: {x_px: number; y_px: number; health: number}|null
} // of the drawn snapshot; at most 20 per second
|{
  kind: "drawing";
  pane: number;
  drawing: Drawing
} // after it has changed
|{
  kind: "tiles";
  pane: number;
  tiles: (TileInfo|null)[]
} // of all islands, while they are shown as tiles; null: before the first snapshot
|{
  kind: "watch_refused";
  pane: number;
  message: string
}
|{
  kind: "camera";
  pane: number;
  camera: Camera
} // the camera followed an organism
|{
  kind: "picked";
  id: number;
  generation: number;
  organism: number|null;
  food: number|null;
  poison: number|null;
  x_px: number;
  y_px: number
} // beside the island: x_px -1
|{
  kind: "columns";
  id: number;
  columns: Message|null
}
|{
  kind: "figures";
  id: number;
  figures: Message
};
