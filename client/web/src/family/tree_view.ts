// TreeView: the part of the width of a tree that is visible, in units of the tree. No DOM.

export interface TreeView {
  begin: number;
  end: number;
}

const units_min = 8; // the fewest organisms in the width

/** Returns a view of the same size that lies within 0 to `width`; the whole width if the view is larger. */
function within(view: TreeView, width: number): TreeView {
  const size = Math.min(view.end - view.begin, width), begin = Math.min(Math.max(view.begin, 0), width - size);
  return {begin, end: begin + size};
}

/** Zooms so that the point at `unit` stays where it is. */
export function zoomed(view: TreeView, width: number, unit: number, factor: number): TreeView {
  const size = Math.max((view.end - view.begin) / factor, Math.min(units_min, width));
  const share = (unit - view.begin) / (view.end - view.begin);
  const begin = unit - Math.min(Math.max(share, 0), 1) * size;
  return within({begin, end: begin + size}, width);
}

export function moved(view: TreeView, width: number, by: number): TreeView {
  return within({begin: view.begin + by, end: view.end + by}, width);
}

/** Moves the view so that the point is in its middle, unless the point is visible. */
export function revealed(view: TreeView, width: number, unit: number): TreeView {
  const is_visible = unit >= view.begin + 0.5 && unit <= view.end - 0.5;
  return is_visible ? view : moved(view, width, unit - (view.begin + view.end) / 2);
}
