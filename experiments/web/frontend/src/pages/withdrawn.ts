/** The page for who has withdrawn. */

import { element, showPage } from "../dom";
import { message } from "../messages";

/** Say that nothing is left. */
export function showWithdrawn(root: HTMLElement): void {
  showPage(root, message("withdrawn.title"), element("p", {}, message("withdrawn.text")));
}
