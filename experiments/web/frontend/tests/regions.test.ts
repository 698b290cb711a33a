import { describe, expect, it } from "vitest";
import { randomNumbers } from "../src/random";
import { Regions } from "../src/regions";
import { discs, runsOf } from "./drawn";

const rows = discs();
const regions = Regions.fromRuns(runsOf(rows));

describe("run lengths", () => {
  it("give back every pixel of the map that they encode", () => {
    const back = rows.map((row, y) => row.map((_, x) => regions.labelAt(x, y)));
    expect(back).toEqual(rows);
  });

  it("are refused when they do not fill the image", () => {
    const runs = runsOf(rows);
    expect(() => Regions.fromRuns({ ...runs, height_px: runs.height_px + 1 })).toThrow(RangeError);
  });

  it("have no region outside the image", () => {
    const outside: [number, number][] = [
      [-1, 5],
      [80, 5],
      [5, -1],
      [5, 44],
    ];
    expect(outside.map(([x, y]) => regions.labelAt(x, y))).toEqual([0, 0, 0, 0]);
  });
});

describe("the label under a point of the page", () => {
  // Property: the centre of every image pixel, and a point just inside each of its edges, belong
  // to that pixel at any place and scale.
  it("is that of the pixel shown there, at odd scales", () => {
    const random = randomNumbers(1);
    for (let trial = 0; trial < 200; trial++) {
      const scale = 0.2 + 3 * random();
      const shown = {
        left: 500 * random(),
        top: 500 * random(),
        width: regions.width_px * scale,
        height: regions.height_px * scale * (0.99 + 0.02 * random()),
      };
      const x = Math.floor(regions.width_px * random());
      const y = Math.floor(regions.height_px * random());
      for (const [right, down] of [
        [0.5, 0.5],
        [0.001, 0.001],
        [0.999, 0.999],
      ] as const) {
        const pageX = shown.left + ((x + right) * shown.width) / regions.width_px;
        const pageY = shown.top + ((y + down) * shown.height) / regions.height_px;
        expect(regions.labelUnder(pageX, pageY, shown)).toBe(rows[y]?.[x]);
      }
    }
  });
});

describe("boxes and outlines", () => {
  it("box every label tightly", () => {
    expect([...regions.boxes().keys()].sort()).toEqual([1, 2, 3, 4, 5, 6, 7, 8]);
    expect(regions.boxes().get(6)).toEqual({ left: 24, top: 26, right: 37, bottom: 39 });
  });

  // Theory: the outline of a region has as many unit edges as there are borders between its
  // pixels and others.
  it("outline a label by every edge between it and others, once", () => {
    const path = regions.outline(3);
    let length = 0;
    for (const [, x, y, direction, end] of path.matchAll(/M(\d+) (\d+)([HV])(\d+)/g)) {
      length += Number(end) - Number(direction === "H" ? x : y);
    }
    let edges = 0;
    const is = (x: number, y: number) => Number(rows[y]?.[x] === 3);
    for (let y = 0; y <= rows.length; y++) {
      for (let x = 0; x <= 80; x++) {
        edges += Math.abs(is(x, y) - is(x - 1, y)) + Math.abs(is(x, y) - is(x, y - 1));
      }
    }
    expect(length).toBe(edges);
  });

  it("follow a region that touches the border of the image", () => {
    const full = Regions.fromRuns({ width_px: 3, height_px: 2, runs: [[1, 6]] });
    expect(full.outline(1)).toBe("M0 0H3M0 2H3M0 0V2M3 0V2");
  });
});

describe("covered pixels", () => {
  it("are those of objects and those outside the image", () => {
    const full = Regions.fromRuns({
      width_px: 3,
      height_px: 2,
      runs: [
        [0, 2],
        [1, 1],
        [0, 3],
      ],
    });
    expect(full.covered({ left: 1, top: 0, right: 3, bottom: 2 })).toBe(1);
    expect(full.covered({ left: -1, top: -1, right: 4, bottom: 2 })).toBe(15 - 6 + 1);
    expect(full.covered({ left: 5, top: 5, right: 7, bottom: 7 })).toBe(4);
  });

  // A page that has no room for its picture once asked for boxes of 10^10 pixels, and hung.
  it("are counted at once in a box however large", () => {
    const far = 1e9;
    const covered = regions.covered({ left: -far, top: -far, right: far, bottom: far });
    expect(covered).toBeGreaterThan(far ** 2);
  });
});
