/** The consent page: nothing is recorded before its button is pressed. */

import type { Study } from "../api";
import { element, pressed, showPage } from "../dom";
import { message } from "../messages";
import { screenFaults } from "../screen-check";

/** Show what the participant agrees to; resolves when they agree, on a screen that will do. */
export async function showConsent(root: HTMLElement, study: Study): Promise<void> {
  const agree = element("button", { class: "primary", type: "button" }, message("consent.agree"));
  const fault = element("p", { class: "fault", role: "status" });
  const check = () => {
    fault.textContent = screenFaults(study.screen).join(" ");
    agree.disabled = fault.textContent !== "";
  };
  const paragraphs = study.consent.text.trim().split(/\n\s*\n/);
  showPage(
    root,
    study.title,
    element("h2", {}, message("consent.title")),
    ...paragraphs.map((text) => element("p", {}, text)),
    fault,
    agree,
  );
  check();
  window.addEventListener("resize", check);
  await pressed(agree);
  window.removeEventListener("resize", check);
}
