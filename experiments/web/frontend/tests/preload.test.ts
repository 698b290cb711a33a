import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { type Loader, PARALLEL, preload } from "../src/preload";
import type { Regions } from "../src/regions";
import { ApiError } from "../src/retry";
import { drawnStimulus } from "./drawn";

const trials = Array.from({ length: 20 }, (_, index) => ({
  index: index + 3,
  pictures: [
    // every image is in two trials
    { image: `/images/${index % 10}`, regions: "/regions/all", width_px: 80, height_px: 44 },
  ],
}));

/** A loader that counts its calls and how many run at once, and fails as the test wants. */
class CountingLoader implements Loader {
  readonly calls: string[] = [];
  running = 0;
  most = 0;
  failures: unknown[] = [];

  image(path: string): Promise<HTMLImageElement> {
    return this.load(path, drawnStimulus().image);
  }

  regions(path: string) {
    return this.load(path, drawnStimulus().regions as Regions);
  }

  private async load<T>(path: string, loaded: T): Promise<T> {
    this.calls.push(path);
    this.most = Math.max(this.most, ++this.running);
    await new Promise((resolve) => setTimeout(resolve, 10));
    this.running -= 1;
    const failure = this.failures.shift();
    if (failure !== undefined) {
      throw failure;
    }
    return loaded;
  }
}

beforeEach(() => {
  vi.useFakeTimers();
});

afterEach(() => {
  vi.useRealTimers();
});

describe("preload", () => {
  it("loads each file once, a bounded number at a time, and tells how far it is", async () => {
    const loader = new CountingLoader();
    const told: [number, number][] = [];
    const done = preload(trials, loader, (loaded, total) => told.push([loaded, total]));
    await vi.advanceTimersByTimeAsync(1000);
    const stimuli = await done;
    expect([...stimuli.keys()]).toEqual(trials.map(({ index }) => index));
    expect(loader.calls.sort()).toEqual([...new Set(loader.calls)].sort());
    expect(loader.calls).toHaveLength(11);
    expect(loader.most).toBe(PARALLEL);
    expect(told).toEqual(Array.from({ length: 12 }, (_, loaded) => [loaded, 11]));
  });

  it("tries a file again that did not come through", async () => {
    const loader = new CountingLoader();
    loader.failures = [new TypeError("Failed to fetch"), new ApiError(503, "busy", "")];
    const done = preload(trials.slice(0, 1), loader);
    await vi.advanceTimersByTimeAsync(10_000);
    expect((await done).size).toBe(1);
    expect(loader.calls).toHaveLength(4);
  });

  it("loads images without regions, in their places", async () => {
    const pictures = ["b", "a"].map((image) => ({
      image,
      regions: null,
      width_px: 4,
      height_px: 3,
    }));
    const loader = new CountingLoader();
    const done = preload([{ index: 0, pictures }], loader);
    await vi.advanceTimersByTimeAsync(1000);
    expect((await done).get(0)).toMatchObject([{ width_px: 4, regions: null }, { height_px: 3 }]);
    expect(loader.calls).toEqual(["b", "a"]);
  });

  it("ends with the server's word when a file is refused", async () => {
    const loader = new CountingLoader();
    loader.failures = [new ApiError(404, "missing", "image: no such image")];
    const refused = expect(preload(trials, loader)).rejects.toThrow("image: no such image");
    await vi.advanceTimersByTimeAsync(1000);
    await refused;
  });
});
