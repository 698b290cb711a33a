/** jsPsych plugin: one image with several objects, of which the participant chooses one. */

import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import { version } from "../../package.json";
import { waitForAnswer } from "../answering";
import { type Onset, showInFrame, watchFrames } from "../frames";
import { Stage, type Stimulus } from "../stage";
import { trialView } from "../trial-view";

const info = {
  name: "odd-one-out",
  version,
  parameters: {
    /** Returns the decoded image and its regions (`Stimulus`). */
    stimulus: { type: ParameterType.FUNCTION, default: undefined },
    /** What the participant is asked. */
    question: { type: ParameterType.STRING, default: undefined },
    /** Where in the study this trial stands, in words. */
    position: { type: ParameterType.STRING, default: undefined },
    /** The share of the study that is done, 0 to 1. */
    progress: { type: ParameterType.FLOAT, default: undefined },
    /** How many objects there are; their labels, and the keys, are 1 to this. */
    choices: { type: ParameterType.INT, default: undefined },
    /** How long the picture's place stays empty before the picture, seconds. */
    blank_s: { type: ParameterType.FLOAT, default: undefined },
    /** How long an answer may take from the onset, seconds; null for no limit. */
    time_limit_s: { type: ParameterType.FLOAT, default: undefined },
  },
  data: {
    /** The label of the chosen object; null when the time limit passed. */
    answer: { type: ParameterType.INT },
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
  },
} as const;

type Info = typeof info;

/** What a trial records. */
export interface OddOneOutData {
  answer: number | null;
  reaction_time_s: number | null;
  onset_requested_s: number;
  onset_measured_s: number;
  frame_interval_s: number | null;
  dropped_frames: number;
  input: "mouse" | "touch" | "keyboard" | "none";
}

/** Shows an empty place, then the image until an answer is given or the time limit passes. */
export default class OddOneOutPlugin implements JsPsychPlugin<Info> {
  static info = info;

  async trial(
    display: HTMLElement,
    trial: TrialType<Info>,
    onLoad: () => void = () => {},
  ): Promise<OddOneOutData> {
    const stimulus: Stimulus = trial.stimulus();
    const stage = new Stage(stimulus, trial.choices);
    display.replaceChildren(trialView(trial, stage));
    stage.setVisible(false);
    stage.place();
    onLoad();
    // Browsers may drop a decoded image that was not shown for long: decode within the blank.
    await Promise.all([delay(trial.blank_s), stimulus.image.decode()]);
    const onset = await showInFrame(() => stage.setVisible(true));
    const data = await observe(stage, onset, trial.choices, trial.time_limit_s);
    stage.dispose();
    return data;
  }
}

async function observe(
  stage: Stage,
  onset: Onset,
  choices: number,
  timeLimit_s: number | null,
): Promise<OddOneOutData> {
  const frames = watchFrames();
  const { answer, given_s, input } = await waitForAnswer(stage, choices, timeLimit_s);
  const { interval_s, dropped } = frames.stop();
  return {
    answer,
    // An answer in the very frame of the onset may carry a time stamp just before it.
    reaction_time_s: given_s === null ? null : Math.max(0, given_s - onset.measured_s),
    onset_requested_s: onset.requested_s,
    onset_measured_s: onset.measured_s,
    frame_interval_s: interval_s,
    dropped_frames: dropped,
    input,
  };
}

function delay(duration_s: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, 1000 * duration_s));
}
