/** Running one trial of a plugin, and acting on its page. */

import { initJsPsych } from "jspsych";
import { vi } from "vitest";
import type { TrialData } from "../src/asked";

/** Parameters that the plugins of all tasks take. */
const ASKED = {
  question: "Which one?",
  position: "Image 1 of 1",
  progress: 0,
  blank_s: 0.02,
  time_limit_s: null,
};

/**
 * Run one trial, call `act` once `ready` matches something on the page, and return what jsPsych
 * recorded.
 */
export async function runTrial(
  trial: Record<string, unknown>,
  ready: string,
  act: () => void | Promise<void>,
): Promise<TrialData> {
  const jsPsych = initJsPsych({ use_webaudio: false });
  const run = jsPsych.run([{ ...ASKED, ...trial }] as unknown as Parameters<typeof jsPsych.run>[0]);
  await vi.waitUntil(() => document.querySelector(ready), { interval: 1 });
  // The answer is awaited from the frame after the pictures' own.
  await new Promise((resolve) => setTimeout(resolve, 50));
  await act();
  await run;
  return jsPsych.data.get().values()[0];
}

/** Press and release a pointer on an element. */
export function press(on: Element | null, type = "mouse", to = on): void {
  const init = { bubbles: true, isPrimary: true, pointerType: type };
  on?.dispatchEvent(new PointerEvent("pointerdown", init));
  to?.dispatchEvent(new PointerEvent("pointerup", init));
}

/** Press a key, on an element or anywhere. */
export function key(code: string, key: string, on: Element | null = document.body): void {
  on?.dispatchEvent(new KeyboardEvent("keydown", { code, key, bubbles: true }));
}
