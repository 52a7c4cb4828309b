// wheel: how far the wheel of a mouse was turned. Browsers count in pixels, lines or pages.

const notch_px = 100, line_px = 33, page_px = 400;
const notches_max = 3; // of one event

/** How many pixels a unit of deltaX and deltaY stands for. */
export function wheel_unit_px({deltaMode}: WheelEvent): number {
  return deltaMode === WheelEvent.DOM_DELTA_LINE  ? line_px :
    deltaMode === WheelEvent.DOM_DELTA_PAGE       ? page_px :
                                                    1;
}

/** The notches away from the user, which zooms in; negative towards the user. */
export function wheel_notches(event: WheelEvent): number {
  return Math.min(Math.max(-event.deltaY * wheel_unit_px(event) / notch_px, -notches_max), notches_max);
}
