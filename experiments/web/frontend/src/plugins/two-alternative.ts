/** jsPsych plugin: two images, of which the participant chooses one. */

import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import { version } from "../../package.json";
import { AnswerButtons } from "../answer-buttons";
import { type Choosable, numberOfTwo, waitForAnswer } from "../answering";
import { ASKED, blank, MEASURED, observe, type TrialData } from "../asked";
import { type Onset, showAfter, showInFrame } from "../frames";
import { drawMask } from "../mask";
import { message } from "../messages";
import { PictureRow, pairNames, pairRow, pictureOf } from "../picture-row";
import type { Stimulus } from "../stimulus";
import { hint, trialView } from "../trial-view";

const info = {
  name: "two-alternative",
  version,
  parameters: {
    ...ASKED,
    /** How long the images, or each of them, stay, seconds; null for until the answer. */
    image_s: { type: ParameterType.FLOAT, default: undefined },
    /** Show them one after the other with so long a mask after each, seconds; null: at once. */
    mask_s: { type: ParameterType.FLOAT, default: undefined },
    /** The trial's number, which makes the masks. */
    seed: { type: ParameterType.INT, default: undefined },
  },
  data: {
    /** 1 for the left or the first image, 2 for the other; null when the time limit passed. */
    answer: { type: ParameterType.INT },
    ...MEASURED,
  },
} as const;

type Info = typeof info;

/** Shows two images at once or one after the other; the answer may come once both were shown. */
export default class TwoAlternativePlugin implements JsPsychPlugin<Info> {
  static info = info;

  async trial(
    display: HTMLElement,
    trial: TrialType<Info>,
    onLoad: () => void = () => {},
  ): Promise<TrialData> {
    const stimuli = trial.stimuli() as [Stimulus, Stimulus];
    const inTurn = trial.mask_s !== null;
    const row = inTurn ? rowInTurn(stimuli, trial.seed) : pairRow(stimuli);
    const buttons = new AnswerButtons(pairNames(inTurn));
    const how = hint(message(inTurn ? "pair.hint_in_turn" : "pair.hint"));
    const view = trialView(trial, row.area, how, buttons.view);
    display.replaceChildren(view);
    row.show();
    row.place();
    buttons.setEnabled(false);
    onLoad();
    const images = stimuli.map(({ image }) => image);
    await blank(trial.blank_s, images);
    const ended = new AbortController();
    const onset = await (inTurn ? showInTurn : showAtOnce)(row, trial, ended.signal);
    buttons.setEnabled(true);
    const choosable: Choosable = {
      area: view,
      numbers: buttons.numbers,
      labelOf: (event) => buttons.numberOf(event) || (inTurn ? 0 : row.placeOf(event)),
    };
    const data = await observe(onset, () =>
      waitForAnswer(choosable, numberOfTwo, trial.time_limit_s),
    );
    ended.abort();
    row.dispose();
    return data;
  }
}

/** Return the two images and the mask after each, for one place. */
function rowInTurn(stimuli: [Stimulus, Stimulus], seed: number): PictureRow {
  const contents = stimuli.flatMap((stimulus, index) => {
    const { width_px, height_px } = stimulus;
    const content = drawMask(width_px, height_px, 2 * seed + index);
    const name = pairNames(true)[index] ?? "";
    return [pictureOf(stimulus, name), { content, width_px, height_px }];
  });
  return new PictureRow(contents, true);
}

interface Durations {
  image_s: number | null;
  mask_s: number | null;
}

async function showAtOnce(
  row: PictureRow,
  { image_s }: Durations,
  signal: AbortSignal,
): Promise<Onset> {
  row.letChoose();
  const onset = await showInFrame(() => row.showAll());
  if (image_s !== null) {
    void showAfter(onset, image_s, () => row.show(), signal);
  }
  return onset;
}

/** Show the first image and its mask; return the onset of the second, which ends by itself. */
async function showInTurn(
  row: PictureRow,
  { image_s, mask_s }: Durations,
  signal: AbortSignal,
): Promise<Onset> {
  const show = async (image: number, before: Onset | null) => {
    const appear = () => row.show(image);
    const onset = await (before ? showAfter(before, mask_s ?? 0, appear) : showInFrame(appear));
    const masked = showAfter(onset, image_s ?? 0, () => row.show(image + 1), signal);
    return { onset, masked };
  };
  const first = await show(1, null);
  const second = await show(3, await first.masked);
  void second.masked.then((masked) => showAfter(masked, mask_s ?? 0, () => row.show(), signal));
  return second.onset;
}
