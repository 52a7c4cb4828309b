// Canvas size: the size of a canvas in CSS pixels and in device pixels.
import type {Size} from "../render/camera";

/** Calls `listener` with the size, and after each change. Both sides are whole numbers of device pixels, so that
 *  nothing is blurred. Returns a function that ends it.
 *
 *  pixel_ratio  device pixels per CSS pixel */
export function observe_size(canvas: Element, listener: (size: Size, pixel_ratio: number) => void): () => void {
  const observer = new ResizeObserver((entries) => {
    const {contentRect: {width, height}, devicePixelContentBoxSize} = entries[entries.length - 1]!;
    if (width > 0 && height > 0) { // it is not hidden
      const exact = devicePixelContentBoxSize?.[0];
      const pixel_ratio = device_pixels(exact?.inlineSize, width) / width;
      listener({width, height: device_pixels(exact?.blockSize, height) / pixel_ratio}, pixel_ratio);
    }
  });
  try {
    observer.observe(canvas, {box: "device-pixel-content-box"});
  } catch {
    observer.observe(canvas); // this browser does not know the size in device pixels
  }
  return () => observer.disconnect();
}

/** exact: may be missing, and is wrong in emulated devices. */
function device_pixels(exact: number|undefined, css_pixels: number): number {
  const rounded = Math.max(Math.round(css_pixels * devicePixelRatio), 1);
  return exact !== undefined && Math.abs(exact - css_pixels * devicePixelRatio) < 1.5 ? exact : rounded;
}
