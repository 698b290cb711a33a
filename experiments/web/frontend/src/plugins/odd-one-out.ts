/** jsPsych plugin: one image with several objects, of which the participant chooses one. */

import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import { version } from "../../package.json";
import { numberOfKey, waitForAnswer } from "../answering";
import { ASKED, blank, MEASURED, observe, type TrialData } from "../asked";
import { showInFrame } from "../frames";
import { message } from "../messages";
import { Stage } from "../stage";
import type { Stimulus } from "../stimulus";
import { hint, trialView } from "../trial-view";

const info = {
  name: "odd-one-out",
  version,
  parameters: {
    ...ASKED,
    /** How many objects there are; their labels, and the keys, are 1 to this. */
    choices: { type: ParameterType.INT, default: undefined },
  },
  data: {
    /** The label of the chosen object; null when the time limit passed. */
    answer: { type: ParameterType.INT },
    ...MEASURED,
  },
} as const;

type Info = typeof info;

/** Shows an empty place, then the image until an answer is given or the time limit passes. */
export default class OddOneOutPlugin implements JsPsychPlugin<Info> {
  static info = info;

  async trial(
    display: HTMLElement,
    trial: TrialType<Info>,
    onLoad: () => void = () => {},
  ): Promise<TrialData> {
    const [stimulus] = trial.stimuli() as [Stimulus];
    const { choices } = trial;
    const stage = new Stage(stimulus, choices);
    display.replaceChildren(
      trialView(trial, stage.area, hint(message("odd_one_out.hint", { choices }))),
    );
    stage.setVisible(false);
    stage.place();
    onLoad();
    await blank(trial.blank_s, [stimulus.image]);
    const onset = await showInFrame(() => stage.setVisible(true));
    const keys = (event: KeyboardEvent) => numberOfKey(event, choices);
    const data = await observe(onset, () => waitForAnswer(stage, keys, trial.time_limit_s));
    stage.dispose();
    return data;
  }
}
