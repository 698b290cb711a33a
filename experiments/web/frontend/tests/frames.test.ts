import { afterEach, describe, expect, it, vi } from "vitest";
import { reportFrames, showInFrame, watchFrames } from "../src/frames";

afterEach(() => {
  vi.unstubAllGlobals();
});

/** An animation clock that the test moves by hand. */
function handClock() {
  let waiting = new Map<number, FrameRequestCallback>();
  let count = 0;
  vi.stubGlobal("requestAnimationFrame", (callback: FrameRequestCallback) => {
    waiting.set(++count, callback);
    return count;
  });
  vi.stubGlobal("cancelAnimationFrame", (id: number) => waiting.delete(id));
  return {
    async frame(time_ms: number) {
      const due = [...waiting.values()];
      waiting = new Map();
      for (const callback of due) {
        callback(time_ms);
      }
      await Promise.resolve();
      await Promise.resolve();
    },
    pending: () => waiting.size,
  };
}

describe("frame report", () => {
  it("counts what was missed from the usual interval", () => {
    const intervals_s = [0.01, 0.01, 0.011, 0.009, 0.02, 0.01, 0.031, 0.01];
    expect(reportFrames(intervals_s)).toEqual({ interval_s: 0.01, dropped: 3 });
  });

  it("takes no jitter below half a frame for a missed one", () => {
    expect(reportFrames([0.016, 0.017, 0.02, 0.016]).dropped).toBe(0);
  });

  it("has no interval without two frames", () => {
    expect(reportFrames([])).toEqual({ interval_s: null, dropped: 0 });
  });
});

describe("the onset", () => {
  it("is the start of the frame after the one in which the page was changed", async () => {
    const clock = handClock();
    const change = vi.fn();
    const onset = showInFrame(change);
    expect(change).not.toHaveBeenCalled();
    await clock.frame(100);
    expect(change).toHaveBeenCalledTimes(1);
    await clock.frame(110);
    expect((await onset).measured_s).toBe(0.11);
  });
});

describe("watching frames", () => {
  it("measures intervals until it is stopped", async () => {
    const clock = handClock();
    const frames = watchFrames();
    for (const time_ms of [0, 10, 20, 30, 50, 60]) {
      await clock.frame(time_ms);
    }
    expect(frames.stop()).toEqual({ interval_s: 0.01, dropped: 1 });
    expect(clock.pending()).toBe(0);
  });

  it("does not blame the display for a hidden page", async () => {
    const clock = handClock();
    const frames = watchFrames();
    const hidden = vi.spyOn(document, "hidden", "get");
    hidden.mockReturnValue(false);
    await clock.frame(0);
    await clock.frame(10);
    hidden.mockReturnValue(true);
    await clock.frame(20);
    hidden.mockReturnValue(false);
    for (const time_ms of [5000, 5010, 5020]) {
      await clock.frame(time_ms);
    }
    expect(frames.stop().dropped).toBe(0);
    hidden.mockRestore();
  });
});
