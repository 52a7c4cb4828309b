// PlotCursor: the line at the numbers that the user reads, the points on the series, and the part of the x axis that a
// drag chooses.
import {column, row} from "./plot_frame";
import type {Frame} from "./plot_frame";
import type {PlotView} from "./plot_content";
import {index_at, PlotNote} from "./plot_note";
import type {PlotTheme} from "./plot_theme";

const selection_alpha = 0.25;

export class PlotCursor {
  readonly note = new PlotNote();
  x: number|null = null; // null: there is no cursor
  pointer_y = 0; // height of the pointer in the window

  /** Draws the cursor on a clear canvas.
   *
   *  selection  the columns of pixels between which the user drags; null: none */
  draw(context: CanvasRenderingContext2D, theme: PlotTheme, view: PlotView, frame: Frame, selection: [
    number, number
  ]|null): void {
    const {area} = frame;
    if (selection !== null) {
      context.fillStyle = theme.quiet;
      context.globalAlpha = selection_alpha;
      context.fillRect(selection[0], area.top, selection[1] - selection[0], area.bottom - area.top);
      context.globalAlpha = 1;
    }
    const x = this.x;
    if (x === null || x < frame.x.min || x > frame.x.max) {
      this.note.hide();
      return;
    }
    const at = column(frame, x);
    context.strokeStyle = theme.quiet;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(Math.round(at) + 0.5, area.top);
    context.lineTo(Math.round(at) + 0.5, area.bottom);
    context.stroke();
    for (const series of view.visible) {
      const index = index_at(series, x);
      if (index !== null && series.kind === "line" && series.name !== "") {
        context.fillStyle = theme.series[series.colour];
        context.beginPath();
        context.arc(at, row(frame, series.y[index]!), 3, 0, 2 * Math.PI);
        context.fill();
      }
    }
    this.note.show(view, frame, x);
  }
}
