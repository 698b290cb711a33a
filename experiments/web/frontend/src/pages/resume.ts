/** The page for a participant who comes back to a session that has begun. */

import type { Session } from "../api";
import { element, pressed, showPage } from "../dom";
import { message } from "../messages";

/** Tell how far the session has come; resolves when the participant goes on. */
export async function showResume(
  root: HTMLElement,
  answered: number,
  { trials, adaptive }: Session,
): Promise<void> {
  const go = element("button", { class: "primary", type: "button" }, message("resume.continue"));
  const told =
    adaptive === null
      ? message("resume.text", { answered, total: trials.length })
      : message("resume.text_open", { answered, total: adaptive.limit });
  const text = element("p", {}, told);
  showPage(root, message("resume.title"), text, go);
  await pressed(go);
}
