/** What the plugins of all tasks take and record. */

import { ParameterType } from "jspsych";
import type { GivenAnswer } from "./answering";
import type { AnswerValue, InputKind } from "./api";
import { type Onset, watchFrames } from "./frames";

/** Parameters of every task. */
export const ASKED = {
  /** Returns the decoded images (`Stimulus[]`), in their places. */
  stimuli: { type: ParameterType.FUNCTION, default: undefined },
  /** What the participant is asked. */
  question: { type: ParameterType.STRING, default: undefined },
  /** Where in the study this trial stands, in words. */
  position: { type: ParameterType.STRING, default: undefined },
  /** The share of the study that is done, 0 to 1. */
  progress: { type: ParameterType.FLOAT, default: undefined },
  /** How long the pictures' place stays empty before them, seconds. */
  blank_s: { type: ParameterType.FLOAT, default: undefined },
  /** How long an answer may take from the onset, seconds; null for no limit. */
  time_limit_s: { type: ParameterType.FLOAT, default: undefined },
} as const;

/** What every task records besides its `answer`. */
export const MEASURED = {
  /** From the measured onset to the press of the button or key, seconds; null as `answer`. */
  reaction_time_s: { type: ParameterType.FLOAT },
  /** When the page was told to show the image, seconds on the page's clock. */
  onset_requested_s: { type: ParameterType.FLOAT },
  /** When the frame that shows the image began, seconds on the same clock. */
  onset_measured_s: { type: ParameterType.FLOAT },
  /** The median interval between frames during the trial, seconds; null if not measurable. */
  frame_interval_s: { type: ParameterType.FLOAT },
  /** How many frames were missed during the trial. */
  dropped_frames: { type: ParameterType.INT },
  /** How the answer was given: `mouse`, `touch`, `keyboard`, or `none` at the time limit. */
  input: { type: ParameterType.STRING },
} as const;

/** What a trial records. */
export interface TrialData {
  /** Null when the time limit passed. */
  answer: AnswerValue | null;
  reaction_time_s: number | null;
  onset_requested_s: number;
  onset_measured_s: number;
  frame_interval_s: number | null;
  dropped_frames: number;
  input: InputKind;
}

/**
 * Wait for an answer and return it with what was measured.
 *
 * @param meaning - The task's answer for the number that was chosen.
 */
export async function observe(
  onset: Onset,
  wait: () => Promise<GivenAnswer>,
  meaning: (chosen: number) => AnswerValue = (chosen) => chosen,
): Promise<TrialData> {
  const frames = watchFrames();
  const { answer, given_s, input } = await wait();
  const { interval_s, dropped } = frames.stop();
  return {
    answer: answer === null ? null : meaning(answer),
    // An answer in the very frame of the onset may carry a time stamp just before it.
    reaction_time_s: given_s === null ? null : Math.max(0, given_s - onset.measured_s),
    onset_requested_s: onset.requested_s,
    onset_measured_s: onset.measured_s,
    frame_interval_s: interval_s,
    dropped_frames: dropped,
    input,
  };
}

/**
 * Wait for the end of the blank, with the images decoded.
 *
 * Browsers may drop a decoded image that was not shown for long: it is decoded within the blank.
 */
export async function blank(duration_s: number, images: HTMLImageElement[]): Promise<void> {
  const delay = new Promise((resolve) => setTimeout(resolve, 1000 * duration_s));
  await Promise.all([delay, ...images.map((image) => image.decode())]);
}
