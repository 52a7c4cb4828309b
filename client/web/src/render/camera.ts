// Camera: which part of the island a pane shows. World coordinates are in px, the model's unit of length; screen
// coordinates in CSS pixels from the upper left corner of the canvas. Both have +x to the right and +y down. All
// functions are pure.
import type {Camera} from "../core/messages";

export interface Size {
  width: number;
  height: number;
}

export interface Point {
  x: number;
  y: number;
}

export interface Rectangle {
  left: number;
  top: number;
  width: number;
  height: number;
}

/** What surrounds an island, in CSS pixels. */
export interface Frame {
  walls: number; // thickness, at any zoom
  margin: number; // around the walls when the whole island is shown
}

/** The rectangle of the canvas in which an island is drawn, in CSS pixels. */
export interface Place extends Rectangle {
  ratio: number; // device pixels per CSS pixel
  frame: Frame;
  is_tile: boolean; // shows the whole island, whatever the camera
  has_details: boolean; // there is room for labels and trails
}

export const zoom_max = 64;
export const pane_frame: Frame = {
  walls: 6,
  margin: 8
};

function clamp(value: number, low: number, high: number): number {
  return Math.min(Math.max(value, low), high);
}

/** The largest zoom at which the whole island and its walls are visible. */
export function zoom_to_fit(canvas: Size, island: Size, {walls, margin} = pane_frame): number {
  const around = 2 * (walls + margin);
  const zoom = Math.min(
    (canvas.width - around) / Math.max(island.width, 1), (canvas.height - around) / Math.max(island.height, 1));
  return clamp(zoom, 1e-6, zoom_max);
}

export function zoom_min(canvas: Size, island: Size): number {
  return zoom_to_fit(canvas, island) / 2;
}

/** The camera that shows the whole island. */
export function fitted(canvas: Size, island: Size, frame = pane_frame): Camera {
  return {x_px: island.width / 2, y_px: island.height / 2, zoom: zoom_to_fit(canvas, island, frame)};
}

/** Keeps the zoom in its range, and the visible part within the island, its walls and their margin. Where the island is
 *  smaller than the canvas, it is in the middle. */
export function clamped(camera: Camera, canvas: Size, island: Size): Camera {
  const zoom = clamp(camera.zoom, zoom_min(canvas, island), zoom_max);
  const around = (pane_frame.walls + pane_frame.margin) / zoom;
  const along = (middle: number, visible: number, size: number): number => {
    const least = visible / zoom / 2 - around; // of the middle
    return least >= size / 2 ? size / 2 : clamp(middle, least, size - least);
  };
  return {
    x_px: along(camera.x_px, canvas.width, island.width),
    y_px: along(camera.y_px, canvas.height, island.height),
    zoom,
  };
}

export function to_screen(camera: Camera, canvas: Size, world: Point): Point {
  return {
    x: canvas.width / 2 + (world.x - camera.x_px) * camera.zoom,
    y: canvas.height / 2 + (world.y - camera.y_px) * camera.zoom
  };
}

export function to_world(camera: Camera, canvas: Size, screen: Point): Point {
  return {
    x: camera.x_px + (screen.x - canvas.width / 2) / camera.zoom,
    y: camera.y_px + (screen.y - canvas.height / 2) / camera.zoom
  };
}

/** Moves the drawn island by this many pixels. */
export function panned(camera: Camera, canvas: Size, island: Size, by: Point): Camera {
  return clamped(
    {...camera, x_px: camera.x_px - by.x / camera.zoom, y_px: camera.y_px - by.y / camera.zoom}, canvas, island);
}

/** Multiplies the zoom. The world point under `screen` does not move, unless the view would leave the island. */
export function zoomed(camera: Camera, canvas: Size, island: Size, screen: Point, factor: number): Camera {
  const zoom = clamp(camera.zoom * factor, zoom_min(canvas, island), zoom_max);
  const held = to_world(camera, canvas, screen);
  return clamped(
    {x_px: held.x - (screen.x - canvas.width / 2) / zoom, y_px: held.y - (screen.y - canvas.height / 2) / zoom, zoom},
    canvas, island);
}

/** The camera that shows of the island `to` the part that `camera` shows of the island `from`. */
export function same_part(camera: Camera, from: Size, to: Size, canvas: Size): Camera {
  const zoom = camera.zoom * Math.min(from.width / to.width, from.height / to.height);
  return clamped(
    {x_px: (camera.x_px / from.width) * to.width, y_px: (camera.y_px / from.height) * to.height, zoom}, canvas, to);
}

/** The visible part of the world. */
export function visible_part(camera: Camera, canvas: Size): Rectangle {
  const corner = to_world(camera, canvas, {x: 0, y: 0});
  return {left: corner.x, top: corner.y, width: canvas.width / camera.zoom, height: canvas.height / camera.zoom};
}

export function contains(rectangle: Rectangle, point: Point): boolean {
  return point.x >= rectangle.left && point.x <= rectangle.left + rectangle.width && point.y >= rectangle.top &&
    point.y <= rectangle.top + rectangle.height;
}

export function is_whole_island_visible(camera: Camera, canvas: Size, island: Size): boolean {
  const visible = visible_part(camera, canvas);
  return contains(visible, {x: 0, y: 0}) && contains(visible, {x: island.width, y: island.height});
}

// ---- minimap ---------------------------------------------------------------------------------------------------

export interface MinimapPlace {
  screen: Rectangle;
  zoom: number; // pixels on the screen per px of the world
}

/** The place of the minimap in the lower right corner: at most 180 pixels, and at most a third of the canvas. */
export function minimap_place(canvas: Size, island: Size): MinimapPlace {
  const side = Math.min(180, Math.min(canvas.width, canvas.height) / 3);
  const margin = 12;
  const zoom = side / Math.max(island.width, island.height, 1);
  const width = island.width * zoom;
  const height = island.height * zoom;
  return {screen: {left: canvas.width - width - margin, top: canvas.height - height - margin, width, height}, zoom};
}

/** The rectangle on the minimap that marks the visible part of the world, clipped at the walls, at least 6 pixels wide
 *  and high. */
export function minimap_frame(place: MinimapPlace, camera: Camera, canvas: Size): Rectangle {
  const visible = visible_part(camera, canvas);
  const {screen, zoom} = place;
  const left = clamp(screen.left + visible.left * zoom, screen.left, screen.left + screen.width);
  const right = clamp(screen.left + (visible.left + visible.width) * zoom, screen.left, screen.left + screen.width);
  const top = clamp(screen.top + visible.top * zoom, screen.top, screen.top + screen.height);
  const bottom = clamp(screen.top + (visible.top + visible.height) * zoom, screen.top, screen.top + screen.height);
  const width = Math.max(right - left, 6);
  const height = Math.max(bottom - top, 6);
  return {left: (left + right - width) / 2, top: (top + bottom - height) / 2, width, height};
}
