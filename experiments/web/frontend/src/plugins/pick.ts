/** jsPsych plugin: one image with several objects, of which the participant picks some. */

import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import { version } from "../../package.json";
import { type Choosable, type GivenAnswer, numberOfKey, waitForAnswer } from "../answering";
import { ASKED, blank, MEASURED, observe, type TrialData } from "../asked";
import { element } from "../dom";
import { showInFrame } from "../frames";
import { message } from "../messages";
import { Stage } from "../stage";
import type { Stimulus } from "../stimulus";
import { hint, trialView } from "../trial-view";

const info = {
  name: "pick",
  version,
  parameters: {
    ...ASKED,
    /** How many objects there are; their labels, and the keys, are 1 to this. */
    choices: { type: ParameterType.INT, default: undefined },
    /** How many of them are picked, at least and at most. */
    picks: { type: ParameterType.INT, array: true, default: undefined },
  },
  data: {
    /** The labels of the picked objects, from the smallest on; null at the time limit. */
    answer: { type: ParameterType.INT, array: true },
    ...MEASURED,
  },
} as const;

type Info = typeof info;

/** What stands for the button in place of a label: no object has it. */
const DONE = -1;

/** Shows the image; objects are picked and taken back until a button says that it is done. */
export default class PickPlugin implements JsPsychPlugin<Info> {
  static info = info;

  async trial(
    display: HTMLElement,
    trial: TrialType<Info>,
    onLoad: () => void = () => {},
  ): Promise<TrialData> {
    const [stimulus] = trial.stimuli() as [Stimulus];
    const { choices } = trial;
    const [least, most] = trial.picks as [number, number];
    const stage = new Stage(stimulus, choices);
    const done = element("button", { class: "primary", type: "button" }, message("pick.done"));
    const picked = new Picked(stage, done, least, most);
    const wanted = least === most ? String(most) : `${least}–${most}`;
    const how = hint(message("pick.hint", { choices, picks: wanted }));
    const view = trialView(trial, stage.area, how, done, picked.status);
    display.replaceChildren(view);
    stage.setVisible(false);
    stage.place();
    onLoad();
    await blank(trial.blank_s, [stimulus.image]);
    const onset = await showInFrame(() => stage.setVisible(true));
    const choosable: Choosable = {
      area: view,
      numbers: new Map([...stage.numbers, [DONE, done]]),
      labelOf: (event) => (event.target === done ? DONE : stage.labelOf(event)),
    };
    const keys = (event: KeyboardEvent) => numberOfKey(event, choices) ?? enter(event, done);
    const wait = () => waitUntilDone(picked, choosable, keys, trial.time_limit_s);
    const data = await observe(onset, wait, () => picked.labels);
    stage.dispose();
    return data;
  }
}

/** Enter means the button, if nothing else has the focus that Enter would press. */
function enter(event: KeyboardEvent, done: HTMLButtonElement): number | null {
  const elsewhere = event.target instanceof HTMLButtonElement;
  return event.key === "Enter" && !elsewhere && !event.repeat && !done.disabled ? DONE : null;
}

/** Let objects be picked until the button or the time limit; return which of the two it was. */
async function waitUntilDone(
  picked: Picked,
  choosable: Choosable,
  keys: (event: KeyboardEvent) => number | null,
  timeLimit_s: number | null,
): Promise<GivenAnswer> {
  const start_ms = performance.now();
  for (;;) {
    const passed_s = (performance.now() - start_ms) / 1000;
    const left_s = timeLimit_s === null ? null : Math.max(0, timeLimit_s - passed_s);
    const given = await waitForAnswer(choosable, keys, left_s);
    if (given.answer === null || given.answer === DONE) {
      return given;
    }
    picked.toggle(given.answer);
  }
}

/** The objects that are picked, as they are shown and told to screen readers. */
class Picked {
  readonly status = element("p", { class: "unseen", role: "status" });
  private readonly chosen = new Set<number>();

  constructor(
    private readonly stage: Stage,
    private readonly done: HTMLButtonElement,
    private readonly least: number,
    private readonly most: number,
  ) {
    done.disabled = true;
    for (const button of stage.numbers.values()) {
      button.setAttribute("aria-pressed", "false");
    }
  }

  /** The labels, from the smallest on. */
  get labels(): number[] {
    return [...this.chosen].sort((a, b) => a - b);
  }

  /** Pick an object or take it back. One more than may be picked takes the place of the last. */
  toggle(label: number): void {
    const before = [...this.chosen];
    const last = before.at(-1);
    if (this.chosen.has(label)) {
      this.chosen.delete(label);
    } else {
      if (this.chosen.size === this.most && last !== undefined) {
        this.chosen.delete(last);
      }
      this.chosen.add(label);
    }
    for (const each of new Set([...before, label])) {
      const held = this.chosen.has(each);
      this.stage.setOutlined(each, held);
      this.stage.numbers.get(each)?.setAttribute("aria-pressed", String(held));
    }
    this.done.disabled = this.chosen.size < this.least;
    const labels = this.labels.join(", ") || message("pick.none");
    this.status.textContent = message("pick.status", { labels });
  }
}
