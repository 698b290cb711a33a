/** jsPsych plugin: tells the right answer after a practice trial. */

import { type JsPsychPlugin, ParameterType, type TrialType } from "jspsych";
import { version } from "../../package.json";
import type { AnswerValue, Feedback } from "../api";
import { element, pressed } from "../dom";
import { message } from "../messages";
import type { Exhibit } from "../stimulus";
import { trialView } from "../trial-view";

const info = {
  name: "feedback",
  version,
  parameters: {
    /** Returns what is shown again, to have the right answer marked on it (`Exhibit`). */
    exhibit: { type: ParameterType.FUNCTION, default: undefined },
    /** Returns in words which answer is the right one. */
    name: { type: ParameterType.FUNCTION, default: undefined },
    /** Returns what the participant answered, and a promise of the server's `Feedback`. */
    outcome: { type: ParameterType.FUNCTION, default: undefined },
    /** What the participant was asked. */
    question: { type: ParameterType.STRING, default: undefined },
    /** Where in the study this trial stands, in words. */
    position: { type: ParameterType.STRING, default: undefined },
    /** The share of the study that is done, 0 to 1. */
    progress: { type: ParameterType.FLOAT, default: undefined },
  },
  data: {
    /** Whether the answer was right; null when the server could not tell. */
    correct: { type: ParameterType.BOOL },
  },
} as const;

type Info = typeof info;

/** What the feedback is about. */
export interface Outcome {
  answer: AnswerValue | null;
  feedback: Promise<Feedback | null>;
}

/** Waits for the server's reply, shows it with the right answer marked, and goes on by button. */
export default class FeedbackPlugin implements JsPsychPlugin<Info> {
  static info = info;

  async trial(
    display: HTMLElement,
    trial: TrialType<Info>,
    onLoad: () => void = () => {},
  ): Promise<{ correct: boolean | null }> {
    const exhibit: Exhibit<AnswerValue> = trial.exhibit();
    const told = element("p", { class: "told", role: "status" }, message("feedback.waiting"));
    const go = element(
      "button",
      { class: "primary", type: "button" },
      message("feedback.continue"),
    );
    go.hidden = true;
    display.replaceChildren(trialView(trial, exhibit.area, told, go));
    exhibit.place();
    onLoad();
    const outcome: Outcome = trial.outcome();
    const feedback = await outcome.feedback.catch(() => null);
    told.textContent = tell(outcome.answer, feedback, trial.name);
    told.dataset.correct = String(feedback?.correct ?? "");
    if (feedback !== null) {
      exhibit.mark(feedback.answer);
    }
    go.hidden = false;
    go.focus();
    await pressed(go);
    exhibit.dispose();
    return { correct: feedback?.correct ?? null };
  }
}

function tell(
  answer: AnswerValue | null,
  feedback: Feedback | null,
  name: (answer: AnswerValue) => string,
): string {
  if (feedback === null) {
    return message("feedback.rejected");
  }
  const verdict = answer === null ? "feedback.late" : "feedback.wrong";
  const right = name(feedback.answer);
  return message(feedback.correct ? "feedback.right" : verdict, { right });
}
