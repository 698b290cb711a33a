/** The jsPsych timeline of a session: each trial, and after practice ones the feedback. */

import type { AnswerReply, Study, Trial } from "./api";
import type { TrialData } from "./asked";
import { message } from "./messages";
import FeedbackPlugin, { type Outcome } from "./plugins/feedback";
import type { Recorder } from "./recorder";
import type { Stimulus } from "./stimulus";
import { presentationOf } from "./tasks";

/**
 * Return the timeline of the trials that are still to be answered.
 *
 * @param trials - All trials of the session, for the counts.
 * @param stimuli - The decoded stimuli of the open trials, by trial index; no others are shown.
 */
export function makeTimeline(
  study: Study,
  trials: Trial[],
  stimuli: Map<number, Stimulus[]>,
  recorder: Recorder,
) {
  return trials.flatMap((trial) => {
    const shown = stimuli.get(trial.index);
    if (shown === undefined) {
      return [];
    }
    const position = positionOf(trial, trials);
    const heading = { position, progress: trial.index / trials.length };
    return steps(study, heading, trial, shown, recorder);
  });
}

/**
 * Return a trial, and after a practice trial its feedback.
 *
 * @param onReply - Waited for before what follows is shown.
 */
export function steps(
  study: Study,
  heading: { position: string; progress: number },
  trial: Trial,
  stimuli: Stimulus[],
  recorder: Recorder,
  onReply: (reply: Promise<AnswerReply>) => Promise<void> = async () => {},
) {
  let outcome: Outcome;
  const { ask, exhibit, name } = presentationOf(study, trial, stimuli);
  const common = { question: study.question, ...heading };
  const question = {
    ...common,
    ...ask,
    stimuli: () => stimuli,
    blank_s: study.timing.blank_s,
    time_limit_s: study.timing.time_limit_s,
    // jsPsych waits for this: the next trial begins when the answer is kept.
    on_finish: async (data: TrialData) => {
      const { reply } = await recorder.answer(trial.index, data);
      outcome = { answer: data.answer, feedback: reply.then(({ feedback }) => feedback) };
      outcome.feedback.catch(() => {}); // told by the feedback, or by the recorder's notice
      await onReply(reply);
    },
  };
  const tell = { ...common, type: FeedbackPlugin, exhibit, name, outcome: () => outcome };
  return trial.feedback ? [question, tell] : [question];
}

function positionOf(trial: Trial, trials: Trial[]): string {
  const phase = trials.filter(({ phase }) => phase === trial.phase);
  const key = trial.phase === "practice" ? "trial.practice" : "trial.main";
  return message(key, { number: phase.indexOf(trial) + 1, total: phase.length });
}
