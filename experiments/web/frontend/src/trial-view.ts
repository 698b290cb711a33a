/** The frame around the picture of a trial: question and progress above, hint or feedback below. */

import { element } from "./dom";
import { message } from "./messages";

/** What a trial's frame says. */
export interface TrialHeading {
  question: string;
  position: string;
  progress: number;
}

/**
 * Return the view of a trial.
 *
 * @param area - What is shown, with or without pictures.
 * @param below - What stands below: the hint how to answer, buttons, or what is told afterwards.
 */
export function trialView(
  { question, position, progress }: TrialHeading,
  area: HTMLElement,
  ...below: Node[]
): HTMLElement {
  const bar = element("progress", {
    max: "1",
    value: String(progress),
    "aria-label": message("trial.progress"),
  });
  return element(
    "main",
    { class: "trial" },
    element(
      "header",
      {},
      element("h1", {}, question),
      element("div", { class: "position" }, element("span", {}, position), bar),
    ),
    area,
    element("footer", {}, ...below),
  );
}

/** Return the line that says how to answer. */
export function hint(text: string): HTMLElement {
  return element("p", { class: "hint" }, text);
}
