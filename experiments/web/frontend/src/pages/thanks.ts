/** The last pages: waiting for the server's acknowledgements, then thanks with the code. */

import type { Completion } from "../api";
import { element, showPage } from "../dom";
import { message } from "../messages";

/** Long enough to read the code. */
const FORWARD_S = 8;

/** Say that the last answers are on their way. */
export function showSending(root: HTMLElement): void {
  showPage(root, message("thanks.sending"), element("progress"));
}

/**
 * Thank the participant, give the completion code, and lead back to where they came from.
 *
 * @param forward - Go there without a press, after a while.
 */
export function showThanks(
  root: HTMLElement,
  { completion_code, completion_url }: Completion,
  forward: boolean,
): void {
  showPage(
    root,
    message("thanks.title"),
    element("p", {}, message("thanks.text")),
    element(
      "p",
      { class: "code" },
      element("span", {}, message("thanks.code")),
      element("output", {}, completion_code),
    ),
    ...(completion_url === null ? [] : wayBack(completion_url, forward)),
  );
}

function wayBack(address: string, forward: boolean): HTMLElement[] {
  const { host } = new URL(address);
  const link = element(
    "a",
    { class: "primary", href: address, rel: "noreferrer" },
    message("thanks.back", { host }),
  );
  if (!forward) {
    return [link];
  }
  setTimeout(() => link.isConnected && location.assign(address), 1000 * FORWARD_S);
  return [element("p", { role: "status" }, message("thanks.forward", { host })), link];
}
