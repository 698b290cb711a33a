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
export function fitImage(image: Size, area: Rectangle, pixelRatio: number): Rectangle {
  return centre(image, area, fittingScale(image, area), pixelRatio);
}

/**
 * Place images in a grid in the middle of an area, all at one scale, as large as they fit.
 *
 * @param columns - How many side by side; null for as many as make the images largest.
 * @param gap - Between neighbours, in CSS pixels.
 * @param caption - The height of the line above each image, in CSS pixels.
 */
export function fitGrid(
  images: readonly Size[],
  area: Rectangle,
  pixelRatio: number,
  { columns, gap, caption }: { columns: number | null; gap: number; caption: number },
): Rectangle[] {
  const largest = {
    width_px: Math.max(...images.map(({ width_px }) => width_px)),
    height_px: Math.max(...images.map(({ height_px }) => height_px)),
  };
  const grid = (across: number) => {
    const down = Math.ceil(images.length / across);
    const width = (area.width - gap * (across - 1)) / across;
    const height = (area.height - gap * (down - 1)) / down - caption;
    const empty = across * down - images.length;
    return { across, down, empty, scale: fittingScale(largest, { width, height }) };
  };
  const numbers = images.map((_, index) => images.length - index);
  const grids = (columns === null ? numbers : [columns]).map(grid);
  const { across, down, scale } = leastBy(grids, (each) => HARDLY * each.empty - each.scale);
  const width = scale * largest.width_px;
  const height = scale * largest.height_px;
  const left = area.left + (area.width - across * (width + gap) + gap) / 2;
  const top = area.top + (area.height - down * (height + caption + gap) + gap) / 2;
  return images.map((image, index) => {
    const cell = {
      left: left + (index % across) * (width + gap),
      top: top + Math.floor(index / across) * (height + caption + gap) + caption,
      width,
      height,
    };
    return centre(image, cell, scale, pixelRatio);
  });
}

/** The size of an image. */
export interface Size {
  width_px: number;
  height_px: number;
}

/** Of grids with images of one size, the one with fewest empty places is best. */
const HARDLY = 1e-9;

function fittingScale(image: Size, area: { width: number; height: number }): number {
  return Math.min(1, area.width / image.width_px, area.height / image.height_px);
}

function centre(image: Size, area: Rectangle, scale: number, pixelRatio: number): Rectangle {
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
 * All numbers stand on the same side of their objects, so that each is read as its own object's
 * and not as the neighbour's; where an image is crowded, on the side where they cover least.
 *
 * @param size - The side of a number's square, in image pixels.
 * @param gap - Its distance from the region's box, in image pixels.
 * @returns The centre of each number in image pixels, by label.
 */
export function numberPlaces(regions: Regions, size: number, gap: number): Map<number, Point> {
  const boxes = [...regions.boxes()];
  const place = (box: Box, [right, down]: Direction): Point => ({
    x: (box.left + box.right) / 2 + right * ((box.right - box.left + size) / 2 + gap),
    y: (box.top + box.bottom) / 2 + down * ((box.bottom - box.top + size) / 2 + gap),
  });
  const covered = (direction: Direction) =>
    sum(boxes.map(([, box]) => regions.covered(squareAround(place(box, direction), size))));
  const best = leastBy(DIRECTIONS, covered);
  return new Map(boxes.map(([label, box]) => [label, place(box, best)]));
}

interface Point {
  x: number;
  y: number;
}

/** Steps to the right and down, 1 being beside the region's box and 0 its middle. */
type Direction = readonly [right: number, down: number];

/** Best first: below, above, the corners (where a round object leaves room), the sides. */
const DIRECTIONS: readonly Direction[] = [
  [0, 1],
  [0, -1],
  [0.75, 0.75],
  [-0.75, 0.75],
  [0.75, -0.75],
  [-0.75, -0.75],
  [1, 0],
  [-1, 0],
];

function squareAround({ x, y }: Point, size: number): Box {
  const left = Math.floor(x - size / 2);
  const top = Math.floor(y - size / 2);
  return { left, top, right: left + Math.ceil(size), bottom: top + Math.ceil(size) };
}

/** The first item of those that measure least. */
function leastBy<T>(items: readonly T[], measure: (item: T) => number): T {
  const measures = items.map(measure);
  return items[measures.indexOf(Math.min(...measures))] as T;
}

function sum(numbers: number[]): number {
  return numbers.reduce((total, number) => total + number, 0);
}
