/** The page for a participant who comes back to a session that has begun. */

import { element, pressed, showPage } from "../dom";
import { message } from "../messages";

/** Tell how far the session has come; resolves when the participant goes on. */
export async function showResume(
  root: HTMLElement,
  answered: number,
  total: number,
): Promise<void> {
  const go = element("button", { class: "primary", type: "button" }, message("resume.continue"));
  const text = element("p", {}, message("resume.text", { answered, total }));
  showPage(root, message("resume.title"), text, go);
  await pressed(go);
}
