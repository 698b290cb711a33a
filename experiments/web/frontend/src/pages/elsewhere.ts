/** The page for who has the study open already. */

import { element, showPage } from "../dom";
import { message } from "../messages";

/** Say that it goes on in the other window. */
export function showElsewhere(root: HTMLElement): void {
  showPage(root, message("elsewhere.title"), element("p", {}, message("elsewhere.text")));
}
