import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { ApiError, FIRST_DELAY_S, isTransient, LONGEST_DELAY_S, retry } from "../src/retry";

beforeEach(() => {
  vi.useFakeTimers();
});

afterEach(() => {
  vi.useRealTimers();
  vi.restoreAllMocks();
});

describe("retry", () => {
  it("doubles its delay up to the longest", async () => {
    vi.spyOn(Math, "random").mockReturnValue(0); // no shortening
    const tries_s: number[] = [];
    const attempt = async () => {
      tries_s.push(Date.now() / 1000);
      throw new TypeError("Failed to fetch");
    };
    void retry(attempt);
    await vi.advanceTimersByTimeAsync(60_000);
    const delays_s = tries_s.slice(1).map((time_s, index) => time_s - (tries_s[index] ?? 0));
    const expected = delays_s.map((_, index) =>
      Math.min(FIRST_DELAY_S * 2 ** index, LONGEST_DELAY_S),
    );
    expect(delays_s.length).toBeGreaterThan(5);
    delays_s.forEach((delay_s, index) => {
      expect(delay_s).toBeCloseTo(expected[index] ?? 0, 3);
    });
  });

  it("gives up at once on what will not pass", async () => {
    const attempt = vi.fn().mockRejectedValue(new ApiError(404, "missing", "no such image"));
    await expect(retry(attempt)).rejects.toThrow("no such image");
    expect(attempt).toHaveBeenCalledTimes(1);
  });

  it.each([
    [new ApiError(500, "", ""), true],
    [new ApiError(429, "", ""), true],
    [new ApiError(408, "", ""), true],
    [new TypeError("Failed to fetch"), true],
    [new DOMException("", "TimeoutError"), true],
    [new ApiError(409, "", ""), false],
    [new ApiError(401, "", ""), false],
    [new DOMException("", "EncodingError"), false],
    [new RangeError("regions"), false],
  ])("knows what may pass (%s)", (error, transient) => {
    expect(isTransient(error)).toBe(transient);
  });
});
