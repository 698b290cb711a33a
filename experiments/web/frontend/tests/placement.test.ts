import { describe, expect, it } from "vitest";
import { fitImage, numberPlaces } from "../src/placement";
import { randomNumbers } from "../src/random";
import { Regions } from "../src/regions";
import { discs, runsOf } from "./drawn";

const image = { width_px: 1024, height_px: 600 };

describe("an image in its area", () => {
  // Properties, over areas and pixel ratios drawn at random.
  it("lies on device pixels, inside the area, never enlarged and hardly stretched", () => {
    const random = randomNumbers(2);
    for (let trial = 0; trial < 500; trial++) {
      const ratio = [1, 1.25, 1.5, 1.75, 2, 3][Math.floor(6 * random())] ?? 1;
      const area = {
        left: 40 * random(),
        top: 80 * random(),
        width: 200 + 2000 * random(),
        height: 150 + 1200 * random(),
      };
      const shown = fitImage(image, area, ratio);
      for (const edge of Object.values(shown)) {
        expect(Math.abs(edge * ratio - Math.round(edge * ratio))).toBeLessThan(1e-6);
      }
      const onePixel = 1 / ratio;
      expect(shown.left).toBeGreaterThanOrEqual(area.left - onePixel);
      expect(shown.top).toBeGreaterThanOrEqual(area.top - onePixel);
      expect(shown.left + shown.width).toBeLessThanOrEqual(area.left + area.width + onePixel);
      expect(shown.top + shown.height).toBeLessThanOrEqual(area.top + area.height + onePixel);
      expect(shown.width).toBeLessThanOrEqual(image.width_px);
      const scale = shown.width / image.width_px;
      expect(Math.abs(shown.height - scale * image.height_px)).toBeLessThanOrEqual(2 * onePixel);
    }
  });

  it("keeps its own size where there is room", () => {
    const shown = fitImage(image, { left: 0, top: 0, width: 1280, height: 800 }, 1);
    expect(shown).toEqual({ left: 128, top: 100, width: 1024, height: 600 });
  });
});

describe("the numbers of the objects", () => {
  const regions = Regions.fromRuns(runsOf(discs()));

  it("stand beside their objects, on none, all on the same side", () => {
    const boxes = regions.boxes();
    const places = numberPlaces(regions, 4, 1);
    const steps = new Set<string>();
    for (const [label, { x, y }] of places) {
      const box = boxes.get(label);
      expect(regions.labelAt(Math.floor(x), Math.floor(y))).toBe(0);
      expect(box).toBeDefined();
      steps.add(`${x - (box?.left ?? 0)},${y - (box?.top ?? 0)}`);
    }
    expect(places.size).toBe(8);
    expect(steps.size).toBe(1);
  });

  it("stand where there is room", () => {
    const full = Regions.fromRuns(runsOf(Array(6).fill([0, 0, 2, 2, 2, 2])));
    const { x, y } = numberPlaces(full, 2, 0).get(2) ?? { x: -1, y: -1 };
    expect({ x, y }).toEqual({ x: 1, y: 3 });
  });
});
