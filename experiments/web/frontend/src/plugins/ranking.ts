/** jsPsych plugin: several images, which the participant brings into order. */

import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import { version } from "../../package.json";
import { waitForAnswer } from "../answering";
import { ASKED, blank, MEASURED, observe, type TrialData } from "../asked";
import { element } from "../dom";
import { showInFrame } from "../frames";
import { message } from "../messages";
import { RankingBoard } from "../ranking-board";
import type { Stimulus } from "../stimulus";
import { hint, trialView } from "../trial-view";

const info = {
  name: "ranking",
  version,
  parameters: {
    ...ASKED,
    /** What the ends of the order are called, best first. */
    ends: { type: ParameterType.STRING, array: true, default: undefined },
    /** Whether images may share a rank. */
    ties: { type: ParameterType.BOOL, default: undefined },
  },
  data: {
    /** The rank of each image in the order shown, 1 for the best; null at the time limit. */
    answer: { type: ParameterType.INT, array: true },
    ...MEASURED,
  },
} as const;

type Info = typeof info;

const DONE = 1;

/** Shows the images in the order given; they are moved until a button says that it is done. */
export default class RankingPlugin implements JsPsychPlugin<Info> {
  static info = info;

  async trial(
    display: HTMLElement,
    trial: TrialType<Info>,
    onLoad: () => void = () => {},
  ): Promise<TrialData> {
    const stimuli = trial.stimuli() as Stimulus[];
    const ends = trial.ends as [string, string];
    const board = new RankingBoard(stimuli, { ends, ties: trial.ties });
    const label = message("ranking.done");
    const done = element("button", { class: "primary", type: "button", disabled: true }, label);
    const how = message(trial.ties ? "ranking.hint_ties" : "ranking.hint", {
      total: stimuli.length,
    });
    const view = trialView(trial, board.area, hint(how), done, board.status);
    display.replaceChildren(view);
    board.setVisible(false);
    board.place();
    onLoad();
    const images = stimuli.map(({ image }) => image);
    await blank(trial.blank_s, images);
    const onset = await showInFrame(() => board.setVisible(true));
    board.letMove();
    done.disabled = false;
    const choosable = {
      area: view,
      numbers: new Map([[DONE, done]]),
      labelOf: ({ target }: PointerEvent) => (target === done ? DONE : 0),
    };
    const wait = () => waitForAnswer(choosable, () => null, trial.time_limit_s);
    const data = await observe(onset, wait, () => board.ranks);
    board.dispose();
    return data;
  }
}
