/** The mask that follows an image: squares of random grey. The lab draws the same (`mask.py`). */

import { element } from "./dom";
import { randomNumbers } from "./random";

/** The side of a square, in pixels of the image. */
const SQUARE_PX = 8;

/** Return the greys, 0 to 255, of a mask's squares, row by row. */
export function maskGreys(count: number, seed: number): number[] {
  const random = randomNumbers(seed);
  return Array.from({ length: count }, () => Math.floor(256 * random()));
}

/**
 * Return a mask of the size of an image.
 *
 * @param seed - The same seed gives the same mask.
 */
export function drawMask(width_px: number, height_px: number, seed: number): HTMLCanvasElement {
  const across = Math.ceil(width_px / SQUARE_PX);
  const greys = maskGreys(across * Math.ceil(height_px / SQUARE_PX), seed);
  const canvas = element("canvas", { "aria-hidden": "true" });
  canvas.width = width_px;
  canvas.height = height_px;
  const context = canvas.getContext("2d");
  for (const [index, grey] of greys.entries()) {
    if (context !== null) {
      context.fillStyle = `rgb(${grey} ${grey} ${grey})`;
      const [x, y] = [index % across, Math.floor(index / across)];
      context.fillRect(SQUARE_PX * x, SQUARE_PX * y, SQUARE_PX, SQUARE_PX);
    }
  }
  return canvas;
}
