/** The page for what the participant cannot put right. */

import { element, showPage } from "../dom";
import { message } from "../messages";

/** Say what is wrong. */
export function showProblem(root: HTMLElement, text: string): void {
  showPage(root, message("problem.title"), element("p", {}, text));
}

/** Say that the server is not reached yet. */
export function showConnecting(root: HTMLElement): void {
  showPage(root, message("problem.connecting"), element("progress"));
}
