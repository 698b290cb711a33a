/** The page for what the participant cannot put right. */

import type { Closed } from "../api";
import { element, showPage } from "../dom";
import { message } from "../messages";

/** Say what is wrong. */
export function showProblem(root: HTMLElement, text: string): void {
  showPage(root, message("problem.title"), element("p", {}, text));
}

/** Say why nobody can begin now, and whether to come again. */
export function showClosed(root: HTMLElement, why: Closed): void {
  showPage(root, message(`closed.${why}.title`), element("p", {}, message(`closed.${why}.text`)));
}

/** Say that the server is not reached yet. */
export function showConnecting(root: HTMLElement): void {
  showPage(root, message("problem.connecting"), element("progress"));
}
