/** Buttons that are answers, numbered from 1 as their keys are. */

import { element } from "./dom";

/** A row of numbered buttons. */
export class AnswerButtons {
  readonly view = element("div", { class: "answers" });
  readonly numbers = new Map<number, HTMLButtonElement>();

  constructor(labels: readonly string[]) {
    for (const [index, label] of labels.entries()) {
      const key = String(index + 1);
      const numeral = element("kbd", { "aria-hidden": "true" }, key);
      const attributes = { class: "answer", type: "button", "aria-keyshortcuts": key };
      this.numbers.set(index + 1, element("button", attributes, numeral, label));
    }
    this.view.append(...this.numbers.values());
  }

  /** Let the buttons be pressed, or not. */
  setEnabled(enabled: boolean): void {
    for (const button of this.numbers.values()) {
      button.disabled = !enabled;
    }
  }

  /** Return the number of the button that a pointer event points at; 0 for none. */
  numberOf({ target }: PointerEvent): number {
    for (const [number, button] of this.numbers) {
      if (target instanceof Node && button.contains(target)) {
        return number;
      }
    }
    return 0;
  }
}
