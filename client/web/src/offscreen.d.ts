// Declarations that TypeScript 4.8 lacks: OffscreenCanvas, and the functions of a worker that the page's library does
// not have.

interface OffscreenCanvas extends EventTarget {
  width: number;
  height: number;
  getContext(kind: "webgl2", options?: WebGLContextAttributes): WebGL2RenderingContext|null;
  getContext(kind: "2d", options?: CanvasRenderingContext2DSettings): OffscreenCanvasRenderingContext2D|null;
}

declare var OffscreenCanvas: {prototype: OffscreenCanvas; new (width: number, height: number): OffscreenCanvas;};

interface OffscreenCanvasRenderingContext2D extends CanvasCompositing, CanvasDrawImage, CanvasDrawPath,
                                                    CanvasFillStrokeStyles, CanvasImageData, CanvasPath,
                                                    CanvasPathDrawingStyles, CanvasRect, CanvasState, CanvasText,
                                                    CanvasTextDrawingStyles, CanvasTransform {
  readonly canvas: OffscreenCanvas;
}

interface HTMLCanvasElement {
  transferControlToOffscreen(): OffscreenCanvas;
}
