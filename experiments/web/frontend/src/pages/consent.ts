/** The consent page: nothing is recorded before its button is pressed. */

import type { Study } from "../api";
import { element, pressed, showPage } from "../dom";
import { message } from "../messages";

/** Show what the participant agrees to; resolves when they agree, in a window large enough. */
export async function showConsent(root: HTMLElement, study: Study): Promise<void> {
  const agree = element("button", { class: "primary", type: "button" }, message("consent.agree"));
  const tooSmall = element("p", { class: "fault", role: "status" });
  const check = () => {
    tooSmall.textContent = windowFault(study.screen);
    agree.disabled = tooSmall.textContent !== "";
  };
  const paragraphs = study.consent.text.trim().split(/\n\s*\n/);
  showPage(
    root,
    study.title,
    element("h2", {}, message("consent.title")),
    ...paragraphs.map((text) => element("p", {}, text)),
    tooSmall,
    agree,
  );
  check();
  window.addEventListener("resize", check);
  await pressed(agree);
  window.removeEventListener("resize", check);
}

function windowFault({ minimum_width_px, minimum_height_px }: Study["screen"]): string {
  if (window.innerWidth >= minimum_width_px && window.innerHeight >= minimum_height_px) {
    return "";
  }
  return message("consent.window", {
    width: minimum_width_px,
    height: minimum_height_px,
    actual_width: window.innerWidth,
    actual_height: window.innerHeight,
  });
}
