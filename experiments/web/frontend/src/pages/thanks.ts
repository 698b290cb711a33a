/** The last pages: waiting for the server's acknowledgements, then thanks with the code. */

import { element, showPage } from "../dom";
import { message } from "../messages";

/** Say that the last answers are on their way. */
export function showSending(root: HTMLElement): void {
  showPage(root, message("thanks.sending"), element("progress"));
}

/** Thank the participant and give the completion code. */
export function showThanks(root: HTMLElement, code: string): void {
  showPage(
    root,
    message("thanks.title"),
    element("p", {}, message("thanks.text")),
    element(
      "p",
      { class: "code" },
      element("span", {}, message("thanks.code")),
      element("output", {}, code),
    ),
  );
}
