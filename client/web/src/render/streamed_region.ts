// StreamedRegion: the region and the level of detail in which a large island is streamed. The region is larger than the
// visible part, so that a small pan stays inside it. It changes at most once per 200 ms. As in evoview
// (island_view.cpp).
import type {Camera} from "../core/messages";
import {contains, Rectangle, Size, visible_part} from "./camera";

/** The region and the level of detail of a View (commands.proto). */
export interface WantedView {
  region: {left_px: number; top_px: number; width_px: number; height_px: number};
  detail: "DETAIL_FULL"|"DETAIL_DOTS"|"DETAIL_DENSITY";
}

const interval_ms = 200;

/** Returns the region for a visible part: twice as wide and high, with the same middle. */
export function region_around({left, top, width, height}: Rectangle): Rectangle {
  return {left: left - width / 2, top: top - height / 2, width: 2 * width, height: 2 * height};
}

export class StreamedRegion {
  #region: Rectangle|null = null;
  #detail: WantedView["detail"]|null = null;
  #changed_ms = -Infinity;

  /** Returns the view to request now; null if the one returned last is still suitable. */
  update(camera: Camera, canvas: Size, detail: WantedView["detail"], now_ms: number): WantedView|null {
    const visible = visible_part(camera, canvas);
    const region = this.#region;
    const covered = region !== null && contains(region, {x: visible.left, y: visible.top}) &&
      contains(region, {x: visible.left + visible.width, y: visible.top + visible.height});
    const is_far_too_large = region !== null && region.width > 6 * visible.width;
    if (
      (covered && !is_far_too_large && detail === this.#detail) ||
      (region !== null && now_ms - this.#changed_ms < interval_ms)) {
      return null;
    }
    this.#region = region_around(visible);
    this.#detail = detail;
    this.#changed_ms = now_ms;
    return {
      region: {
        left_px: this.#region.left,
        top_px: this.#region.top,
        width_px: this.#region.width,
        height_px: this.#region.height
      },
      detail
    };
  }

  forget(): void {
    this.#region = this.#detail = null;
    this.#changed_ms = -Infinity;
  }
}
