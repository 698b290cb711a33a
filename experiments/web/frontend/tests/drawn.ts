/** Small region maps and stimuli for tests, and a reproducible source of random numbers. */

import type { RegionRuns } from "../src/api";
import { Regions } from "../src/regions";
import type { Stimulus } from "../src/stimulus";

/** Where every element is in tests: the picture has twice its size, 160 by 88 CSS pixels. */
export const SHOWN = new DOMRect(10, 20, 160, 88);

/** Encode rows of labels as the server does. */
export function runsOf(rows: number[][]): RegionRuns {
  const runs: [number, number][] = [];
  for (const label of rows.flat()) {
    const last = runs.at(-1);
    if (last?.[0] === label) {
      last[1] += 1;
    } else {
      runs.push([label, 1]);
    }
  }
  return { width_px: rows[0]?.length ?? 0, height_px: rows.length, runs };
}

/** Rows with discs of radius 6 in two rows of four, labels 1 to 8. */
export function discs(width_px = 80, height_px = 44): number[][] {
  return Array.from({ length: height_px }, (_, y) =>
    Array.from({ length: width_px }, (_, x) => {
      const column = Math.floor(x / 20);
      const row = Math.floor(y / 22);
      const inside = (x - 20 * column - 10) ** 2 + (y - 22 * row - 10) ** 2 <= 36;
      return inside ? 4 * row + column + 1 : 0;
    }),
  );
}

/** An image of discs, eight of them to choose among. */
export function drawnStimulus(): Stimulus {
  const regions = Regions.fromRuns(runsOf(discs()));
  return { ...plainStimulus(), regions };
}

/** An image of the same size without regions. */
export function plainStimulus(): Stimulus {
  return { image: new Image(), width_px: 80, height_px: 44, regions: null };
}
