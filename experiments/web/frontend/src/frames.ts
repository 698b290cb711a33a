/** Times of frames on the screen, from the browser's animation clock, in seconds. */

/** An interval this many times the usual one means that at least one frame came late. */
const LATE = 1.5;

/** When a stimulus was asked for and when its first frame began. */
export interface Onset {
  requested_s: number;
  measured_s: number;
}

/** What the frames of a trial show about the display. */
export interface FrameReport {
  /** The median interval between frames; null with fewer than two frames. */
  interval_s: number | null;
  /** How many frames were missed. */
  dropped: number;
}

/** Return the moment of the next frame. */
export function nextFrame(): Promise<number> {
  return new Promise((resolve) => requestAnimationFrame((time_ms) => resolve(time_ms / 1000)));
}

/**
 * Change the page at the start of a frame and measure when that frame was shown.
 *
 * Changes made in a frame's callback are painted at its end, so the start of the following frame
 * is the best estimate that a browser gives of the moment they appear.
 */
export async function showInFrame(change: () => void): Promise<Onset> {
  await nextFrame();
  const requested_s = performance.now() / 1000;
  change();
  return { requested_s, measured_s: await nextFrame() };
}

/**
 * Change the page so that the change appears a certain time after an onset, to the nearest frame.
 *
 * @param signal - Gives the change up when it aborts; the promise then never resolves.
 */
export async function showAfter(
  onset: Onset,
  duration_s: number,
  change: () => void,
  signal?: AbortSignal,
): Promise<Onset> {
  let [before_s, now_s] = [onset.measured_s, await nextFrame()];
  let frame_s = now_s - before_s;
  // A change appears one frame after that in which it is made.
  while (now_s + 1.5 * frame_s < onset.measured_s + duration_s && !signal?.aborted) {
    [before_s, now_s] = [now_s, await nextFrame()];
    frame_s = Math.min(frame_s, now_s - before_s);
  }
  if (signal?.aborted) {
    return new Promise(() => {});
  }
  const requested_s = performance.now() / 1000;
  change();
  return { requested_s, measured_s: await nextFrame() };
}

/** Watch frames until `stop` is called. */
export function watchFrames(): { stop(): FrameReport } {
  const intervals_s: number[] = [];
  let previous_s: number | null = null;
  let request = requestAnimationFrame(function record(time_ms) {
    const time_s = time_ms / 1000;
    if (previous_s !== null) {
      intervals_s.push(time_s - previous_s);
    }
    // A hidden page gets no frames: that is no failure of the display.
    previous_s = document.hidden ? null : time_s;
    request = requestAnimationFrame(record);
  });
  return {
    stop() {
      cancelAnimationFrame(request);
      return reportFrames(intervals_s);
    },
  };
}

/** Summarise intervals between frames, in seconds. */
export function reportFrames(intervals_s: readonly number[]): FrameReport {
  const interval_s = median(intervals_s);
  if (interval_s === null || interval_s <= 0) {
    return { interval_s: null, dropped: 0 };
  }
  let dropped = 0;
  for (const length_s of intervals_s) {
    if (length_s > LATE * interval_s) {
      dropped += Math.round(length_s / interval_s) - 1;
    }
  }
  return { interval_s, dropped };
}

function median(values: readonly number[]): number | null {
  const sorted = values.toSorted((a, b) => a - b);
  const low = sorted[Math.floor((sorted.length - 1) / 2)];
  const high = sorted[Math.ceil((sorted.length - 1) / 2)];
  return low === undefined || high === undefined ? null : (low + high) / 2;
}
