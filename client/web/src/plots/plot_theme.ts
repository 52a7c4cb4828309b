// plot_theme: the colours of plots, which follow the theme of the page.
import type {SeriesColour} from "./plot_content";

/** Colours after Okabe and Ito, lighter or darker so that each has a contrast of 3:1 in both themes. app.css defines
 *  them as --series-…; these are used if it does not. */
export const series_colours: {readonly[name in SeriesColour]: string} = {
  orange: "#b87700",
  sky: "#3a94cf",
  green: "#008a66",
  blue: "#005fa8",
  vermilion: "#cf5200",
  purple: "#b8568f",
  grey: "#6e6e74",
};
export const band_alpha = 0.2;
export const band_sample_alpha = 1.6 * band_alpha; // of a band in the legend, which lies on no line

export interface PlotTheme {
  text: string;
  quiet: string;
  grid: string;
  line: string;
  surface: string;
  mark: string;
  font: string;
  series: {[name in SeriesColour]: string};
}

export function theme_of(element: Element): PlotTheme {
  const style = getComputedStyle(element);
  const value = (name: string, otherwise: string) => style.getPropertyValue(name).trim() || otherwise;
  const series = {...series_colours};
  for (const name of Object.keys(series) as SeriesColour[]) {
    series[name] = value(`--series-${name}`, series_colours[name]);
  }
  return {
    text: value("--text", "#1c1c22"),
    quiet: value("--text-2", "#5c5c66"),
    grid: value("--plot-grid", "#e2e2e6"),
    line: value("--line", "#b8b8c2"),
    surface: value("--plot-background", value("--surface", "#fcfcfd")),
    mark: value("--plot-mark", "#4a3a96"),
    font: style.fontFamily || "sans-serif",
    series,
  };
}

const themed = new Set<() => void>();

/** Calls `redraw` after each change of the theme, until the returned function is called. */
export function on_theme_change(redraw: () => void): () => void {
  if (!is_watching) {
    watch_theme();
  }
  themed.add(redraw);
  return () => void themed.delete(redraw);
}

let is_watching = false;
function watch_theme(): void {
  is_watching = true;
  const redraw_all = () => themed.forEach((redraw) => redraw());
  new MutationObserver(redraw_all)
    .observe(document.documentElement, {attributes: true, attributeFilter: ["data-theme", "class"]});
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw_all);
}
