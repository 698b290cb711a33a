/** jsPsych plugin: tells the right answer after a practice trial. */

import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import { version } from "../../package.json";
import type { Feedback } from "../api";
import { element, pressed } from "../dom";
import { message } from "../messages";
import { Stage } from "../stage";
import { trialView } from "../trial-view";

const info = {
  name: "feedback",
  version,
  parameters: {
    /** Returns the decoded image and its regions (`Stimulus`). */
    stimulus: { type: ParameterType.FUNCTION, default: undefined },
    /** Returns what the participant answered, and a promise of the server's `Feedback`. */
    outcome: { type: ParameterType.FUNCTION, default: undefined },
    /** What the participant was asked. */
    question: { type: ParameterType.STRING, default: undefined },
    /** Where in the study this trial stands, in words. */
    position: { type: ParameterType.STRING, default: undefined },
    /** The share of the study that is done, 0 to 1. */
    progress: { type: ParameterType.FLOAT, default: undefined },
    /** How many objects there are. */
    choices: { type: ParameterType.INT, default: undefined },
  },
  data: {
    /** Whether the answer was right; null when the server could not tell. */
    correct: { type: ParameterType.BOOL },
  },
} as const;

type Info = typeof info;

/** What the feedback is about. */
export interface Outcome {
  answer: number | null;
  feedback: Promise<Feedback | null>;
}

/** Waits for the server's reply, shows it with the right object outlined, and goes on by button. */
export default class FeedbackPlugin implements JsPsychPlugin<Info> {
  static info = info;

  async trial(
    display: HTMLElement,
    trial: TrialType<Info>,
    onLoad: () => void = () => {},
  ): Promise<{ correct: boolean | null }> {
    const stage = new Stage(trial.stimulus(), trial.choices);
    const told = element("p", { class: "told", role: "status" }, message("feedback.waiting"));
    const go = element(
      "button",
      { class: "primary", type: "button" },
      message("feedback.continue"),
    );
    go.hidden = true;
    display.replaceChildren(trialView(trial, stage, told, go));
    stage.place();
    onLoad();
    const outcome: Outcome = trial.outcome();
    const feedback = await outcome.feedback.catch(() => null);
    told.textContent = tell(outcome.answer, feedback);
    told.dataset.correct = String(feedback?.correct ?? "");
    if (feedback !== null) {
      stage.outline(feedback.answer);
    }
    go.hidden = false;
    go.focus();
    await pressed(go);
    stage.dispose();
    return { correct: feedback?.correct ?? null };
  }
}

function tell(answer: number | null, feedback: Feedback | null): string {
  if (feedback === null) {
    return message("feedback.rejected");
  }
  if (feedback.correct) {
    return message("feedback.right", { answer: feedback.answer });
  }
  const key = answer === null ? "feedback.late" : "feedback.wrong";
  return message(key, { answer: feedback.answer });
}
