/** The jsPsych timeline of an adaptive session: each answer's reply brings the trial that follows. */

import type { Adaptive, AnswerReply, Study, Trial } from "./api";
import { element } from "./dom";
import { message } from "./messages";
import type { Recorder } from "./recorder";
import type { Stimulus } from "./stimulus";
import { steps } from "./timeline";
import { trialView } from "./trial-view";

/** How long a reply may take before the page says that it waits, milliseconds. */
const PATIENCE_MS = 600;

type Timeline = ReturnType<typeof steps>;

/**
 * Return a timeline that begins with a trial and grows while it runs.
 *
 * @param stimuli - Every decoded stimulus that may be shown, by its image's address.
 * @param display - Returns where trials are shown.
 */
export function growTimeline(
  study: Study,
  first: Trial,
  adaptive: Adaptive,
  stimuli: Map<string, Stimulus>,
  recorder: Recorder,
  display: () => HTMLElement,
): Timeline {
  const timeline: Timeline = [];
  const append = (trial: Trial) => {
    const shown = trial.pictures.map(({ image }) => stimuli.get(image) as Stimulus);
    const heading = {
      position: positionOf(trial, adaptive),
      progress: trial.index / adaptive.limit,
    };
    const onReply = async (reply: Promise<AnswerReply>) => {
      const waiting = setTimeout(() => showWaiting(display(), study, heading), PATIENCE_MS);
      const { next } = await reply.finally(() => clearTimeout(waiting));
      if (next) {
        append(next);
      }
    };
    // jsPsych goes on with what was added to the timeline meanwhile.
    timeline.push(...steps(study, heading, trial, shown, recorder, onReply));
  };
  append(first);
  return timeline;
}

function showWaiting(
  display: HTMLElement,
  { question }: Study,
  heading: { position: string; progress: number },
): void {
  const told = element("p", { class: "told", role: "status" }, message("trial.waiting"));
  const area = element("div", { class: "stage" });
  display.replaceChildren(trialView({ question, ...heading }, area, told));
}

function positionOf({ index, phase }: Trial, { limit, practice }: Adaptive): string {
  return phase === "practice"
    ? message("trial.practice", { number: index + 1, total: practice })
    : message("trial.main_open", { number: index + 1 - practice, total: limit - practice });
}
