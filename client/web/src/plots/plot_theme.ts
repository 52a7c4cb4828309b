// plot_theme: the colours of plots, which follow the theme of the page.
import {css_colours, type CssColours} from "../widgets/theme";
import type {SeriesColour} from "./plot_content";

export const band_alpha = 0.2;
export const band_sample_alpha = 1.6 * band_alpha; // of a band in the legend, which lies on no line

/** Of PlotTheme, as app.css defines them. The colours of series are after Okabe and Ito, lighter or darker so that each
 *  has a contrast of 3:1 in both themes. */
const theme_colours = {
  text: "--text",
  quiet: "--text-2",
  grid: "--plot-grid",
  line: "--line",
  surface: "--plot-background",
  mark: "--plot-mark",
};
const series_colours: {[colour in SeriesColour]: string} = {
  orange: "--series-orange",
  sky: "--series-sky",
  green: "--series-green",
  blue: "--series-blue",
  vermilion: "--series-vermilion",
  purple: "--series-purple",
  grey: "--series-grey",
};

export interface PlotTheme extends CssColours<typeof theme_colours> {
  font: string;
  series: CssColours<typeof series_colours>;
}

export function theme_of(element: Element): PlotTheme {
  return {
    ...css_colours(element, theme_colours),
    font: getComputedStyle(element).fontFamily,
    series: css_colours(element, series_colours),
  };
}
