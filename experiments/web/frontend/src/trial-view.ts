/** The frame around the picture of a trial: question and progress above, hint or feedback below. */

import { element } from "./dom";
import { message } from "./messages";
import type { Stage } from "./stage";

/** What a trial's frame says. */
export interface TrialHeading {
  question: string;
  position: string;
  progress: number;
  choices: number;
}

/**
 * Return the view of a trial.
 *
 * @param below - What stands below the picture in place of the hint how to answer.
 */
export function trialView(
  { question, position, progress, choices }: TrialHeading,
  stage: Stage,
  ...below: Node[]
): HTMLElement {
  const bar = element("progress", {
    max: "1",
    value: String(progress),
    "aria-label": message("trial.progress"),
  });
  const hint = element("p", { class: "hint" }, message("trial.hint", { choices }));
  return element(
    "main",
    { class: "trial" },
    element(
      "header",
      {},
      element("h1", {}, question),
      element("div", { class: "position" }, element("span", {}, position), bar),
    ),
    stage.area,
    element("footer", {}, ...(below.length > 0 ? below : [hint])),
  );
}
