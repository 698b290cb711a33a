/** jsPsych plugin: one image that is judged, perhaps gone before the answer. */

import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import { version } from "../../package.json";
import { AnswerButtons } from "../answer-buttons";
import { numberOfTwo, waitForAnswer } from "../answering";
import { ASKED, blank, MEASURED, observe, type TrialData } from "../asked";
import { showAfter, showInFrame } from "../frames";
import { message } from "../messages";
import { PictureRow, pictureOf } from "../picture-row";
import type { Stimulus } from "../stimulus";
import { hint, trialView } from "../trial-view";

const info = {
  name: "yes-no",
  version,
  parameters: {
    ...ASKED,
    /** What the two buttons say, yes first. */
    labels: { type: ParameterType.STRING, array: true, default: undefined },
    /** How long the image stays, seconds; null for until the answer. */
    image_s: { type: ParameterType.FLOAT, default: undefined },
  },
  data: {
    /** 1 for yes, 0 for no; null when the time limit passed. */
    answer: { type: ParameterType.INT },
    ...MEASURED,
  },
} as const;

type Info = typeof info;

/** Shows an empty place, then the image; two buttons below take the answer. */
export default class YesNoPlugin implements JsPsychPlugin<Info> {
  static info = info;

  async trial(
    display: HTMLElement,
    trial: TrialType<Info>,
    onLoad: () => void = () => {},
  ): Promise<TrialData> {
    const [stimulus] = trial.stimuli() as [Stimulus];
    const row = new PictureRow([pictureOf(stimulus, message("yes_no.image"))]);
    const buttons = new AnswerButtons(trial.labels);
    const view = trialView(trial, row.area, hint(message("yes_no.hint")), buttons.view);
    display.replaceChildren(view);
    row.show();
    row.place();
    buttons.setEnabled(false);
    onLoad();
    await blank(trial.blank_s, [stimulus.image]);
    const onset = await showInFrame(() => {
      row.showAll();
      buttons.setEnabled(true);
    });
    const answered = new AbortController();
    if (trial.image_s !== null) {
      void showAfter(onset, trial.image_s, () => row.show(), answered.signal);
    }
    const choosable = {
      area: view,
      numbers: buttons.numbers,
      labelOf: (event: PointerEvent) => buttons.numberOf(event),
    };
    const wait = () => waitForAnswer(choosable, numberOfTwo, trial.time_limit_s);
    const data = await observe(onset, wait, (button) => 2 - button);
    answered.abort();
    row.dispose();
    return data;
  }
}
