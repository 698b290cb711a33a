/** Where an image and the numbers of its objects go in the space that the window leaves. */

import type { Box, Regions } from "./regions";

/** A rectangle in CSS pixels. */
export interface Rectangle {
  left: number;
  top: number;
  width: number;
  height: number;
}

/**
 * Centre an image in an area, shrunk to fit and never enlarged.
 *
 * Its edges fall on device pixels: browsers move a picture to whole device pixels when they paint
 * it but not when they report its place, and a click would be off by a part of a pixel.
 *
 * @param area - The space to fill, in CSS pixels from the viewport's corner.
 * @param pixelRatio - Device pixels per CSS pixel.
 */
export function fitImage(
  image: { width_px: number; height_px: number },
  area: Rectangle,
  pixelRatio: number,
): Rectangle {
  const scale = Math.min(1, area.width / image.width_px, area.height / image.height_px);
  const width = Math.max(1, Math.floor(image.width_px * scale * pixelRatio));
  const height = Math.max(1, Math.floor(image.height_px * scale * pixelRatio));
  const left = Math.round((area.left + area.width / 2) * pixelRatio - width / 2);
  const top = Math.round((area.top + area.height / 2) * pixelRatio - height / 2);
  return {
    left: left / pixelRatio,
    top: top / pixelRatio,
    width: width / pixelRatio,
    height: height / pixelRatio,
  };
}

/**
 * Find a place for each region's number: beside the region, over no region, inside the image.
 *
 * @param size - The side of a number's square, in image pixels.
 * @param gap - Its distance from the region's box, in image pixels.
 * @returns The centre of each number in image pixels, by label. Where an image is too crowded,
 *   the place that covers least.
 */
export function numberPlaces(
  regions: Regions,
  size: number,
  gap: number,
): Map<number, { x: number; y: number }> {
  const places = new Map<number, { x: number; y: number }>();
  for (const [label, box] of regions.boxes()) {
    const squares = candidates(box, size / 2 + gap).map((centre) => ({
      centre,
      covered: regions.covered(squareAround(centre, size)),
    }));
    const best = squares.reduce((a, b) => (b.covered < a.covered ? b : a));
    places.set(label, best.centre);
  }
  return places;
}

/** Below, above, to the sides, then the corners of a region's box. */
function candidates(box: Box, away: number): { x: number; y: number }[] {
  const middle = { x: (box.left + box.right) / 2, y: (box.top + box.bottom) / 2 };
  const outer = {
    left: box.left - away,
    right: box.right + away,
    top: box.top - away,
    bottom: box.bottom + away,
  };
  return [
    { x: middle.x, y: outer.bottom },
    { x: middle.x, y: outer.top },
    { x: outer.right, y: middle.y },
    { x: outer.left, y: middle.y },
    { x: box.right, y: outer.bottom - away / 2 },
    { x: box.left, y: outer.bottom - away / 2 },
    { x: box.right, y: outer.top + away / 2 },
    { x: box.left, y: outer.top + away / 2 },
  ];
}

function squareAround({ x, y }: { x: number; y: number }, size: number): Box {
  const left = Math.floor(x - size / 2);
  const top = Math.floor(y - size / 2);
  return { left, top, right: left + Math.ceil(size), bottom: top + Math.ceil(size) };
}
