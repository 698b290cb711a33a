/** The small line that tells of the connection without interrupting the study. */

import { element } from "./dom";
import { type MessageKey, message } from "./messages";

/** A line at the foot of the window, empty while everything works. */
export class Notice {
  private readonly line = element("p", { class: "notice", role: "status" });

  constructor(parent: HTMLElement) {
    parent.append(this.line);
  }

  /** Show a text, or nothing. */
  show(key: MessageKey | null): void {
    this.line.textContent = key === null ? "" : message(key);
  }
}
