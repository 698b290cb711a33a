/** The clickable regions of an image: a label for each of its pixels. */

import type { RegionRuns } from "./api";

export const BACKGROUND = 0;

/** A rectangle in image pixels: columns `left` to `right`, rows `top` to `bottom`, ends excluded. */
export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/**
 * A label image. It arrives as run lengths and not as a picture because browsers that protect
 * their users' privacy falsify the pixels read back from a canvas.
 */
export class Regions {
  private foundBoxes: Map<number, Box> | null = null;

  private constructor(
    readonly width_px: number,
    readonly height_px: number,
    private readonly labels: Uint8Array,
  ) {}

  /**
   * Expand run lengths.
   *
   * @throws RangeError if the lengths do not add up to the size of the image.
   */
  static fromRuns({ width_px, height_px, runs }: RegionRuns): Regions {
    const labels = new Uint8Array(width_px * height_px);
    let end = 0;
    for (const [label, length] of runs) {
      labels.fill(label, end, end + length);
      end += length;
    }
    if (end !== labels.length) {
      throw new RangeError(`regions: runs of ${end} pixels for an image of ${labels.length}`);
    }
    return new Regions(width_px, height_px, labels);
  }

  /** Return the label at a pixel; outside the image is background. */
  labelAt(x_px: number, y_px: number): number {
    const inside = x_px >= 0 && y_px >= 0 && x_px < this.width_px && y_px < this.height_px;
    return inside ? (this.labels[y_px * this.width_px + x_px] ?? BACKGROUND) : BACKGROUND;
  }

  /**
   * Return the label under a point of the page.
   *
   * @param x - The point's distance from the left of the viewport, CSS pixels.
   * @param y - Its distance from the top.
   * @param shown - Where the image is shown, at whatever scale.
   */
  labelUnder(
    x: number,
    y: number,
    shown: { left: number; top: number; width: number; height: number },
  ): number {
    const x_px = Math.floor(((x - shown.left) / shown.width) * this.width_px);
    const y_px = Math.floor(((y - shown.top) / shown.height) * this.height_px);
    return this.labelAt(x_px, y_px);
  }

  /** Return the smallest box around each label, by label. */
  boxes(): ReadonlyMap<number, Box> {
    this.foundBoxes ??= this.findBoxes();
    return this.foundBoxes;
  }

  private findBoxes(): Map<number, Box> {
    const boxes = new Map<number, Box>();
    for (let y = 0; y < this.height_px; y++) {
      for (let x = 0; x < this.width_px; x++) {
        const label = this.labelAt(x, y);
        const box = boxes.get(label);
        if (box !== undefined) {
          box.left = Math.min(box.left, x);
          box.right = Math.max(box.right, x + 1);
          box.bottom = y + 1;
        } else if (label !== BACKGROUND) {
          boxes.set(label, { left: x, top: y, right: x + 1, bottom: y + 1 });
        }
      }
    }
    return boxes;
  }

  /** Return how many pixels of a box belong to a region; those outside the image count too. */
  covered(box: Box): number {
    // Only what lies inside is looked at: where an image has hardly any room, a box is huge.
    const left = Math.max(box.left, 0);
    const right = Math.max(left, Math.min(box.right, this.width_px));
    const top = Math.max(box.top, 0);
    const bottom = Math.max(top, Math.min(box.bottom, this.height_px));
    let count = (box.right - box.left) * (box.bottom - box.top) - (right - left) * (bottom - top);
    for (let y = top; y < bottom; y++) {
      for (let x = left; x < right; x++) {
        count += Number(this.labelAt(x, y) !== BACKGROUND);
      }
    }
    return count;
  }

  /**
   * Return the outline of a label along the edges of its pixels, as SVG path data in image
   * pixels.
   */
  outline(label: number): string {
    const is = (x: number, y: number) => this.labelAt(x, y) === label;
    const horizontal = segments(this.height_px, this.width_px, (y, x) => is(x, y) !== is(x, y - 1));
    const vertical = segments(this.width_px, this.height_px, (x, y) => is(x, y) !== is(x - 1, y));
    return [
      ...horizontal.map(({ line, from, to }) => `M${from} ${line}H${to}`),
      ...vertical.map(({ line, from, to }) => `M${line} ${from}V${to}`),
    ].join("");
  }
}

/** Join neighbouring border edges on each grid line into segments. */
function segments(lines: number, length: number, isBorder: (line: number, at: number) => boolean) {
  const found: { line: number; from: number; to: number }[] = [];
  for (let line = 0; line <= lines; line++) {
    let from: number | null = null;
    for (let at = 0; at <= length; at++) {
      const border = at < length && isBorder(line, at);
      if (border && from === null) {
        from = at;
      } else if (!border && from !== null) {
        found.push({ line, from, to: at });
        from = null;
      }
    }
  }
  return found;
}
