/** The button by which a participant leaves for good, with all their answers erased. */

import { api, type Credentials } from "./api";
import { element } from "./dom";
import { forget } from "./memory";
import { message } from "./messages";
import { showWithdrawn } from "./pages/withdrawn";
import { ApiError, retry } from "./retry";

/**
 * Put the button in its corner.
 *
 * @param root - The study's pages; they go when the participant has withdrawn.
 * @param onWithdrawn - Called when the server has erased everything.
 */
export function offerWithdrawal(
  root: HTMLElement,
  study: string,
  credentials: Credentials,
  onWithdrawn: () => void,
): void {
  const button = element("button", { class: "leave", type: "button" }, message("withdraw.button"));
  button.addEventListener("click", async () => {
    button.blur(); // so that no key meant for a trial presses it again
    if (!window.confirm(message("withdraw.sure"))) {
      return;
    }
    button.disabled = true;
    await erase(credentials);
    onWithdrawn();
    forget(study);
    button.remove();
    // What runs on has no place on the page any more, and sends nothing.
    const page = element("div");
    root.replaceWith(page);
    showWithdrawn(page);
  });
  document.body.append(button);
}

async function erase(credentials: Credentials): Promise<void> {
  try {
    await retry(() => api.withdraw(credentials));
  } catch (error) {
    // The reply to an earlier try was lost: there is nothing left.
    if (!(error instanceof ApiError && error.status === 410)) {
      throw error;
    }
  }
}
