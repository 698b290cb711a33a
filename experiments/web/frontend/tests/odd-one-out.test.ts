import { initJsPsych } from "jspsych";
import { afterEach, describe, expect, it, vi } from "vitest";
import type { TrialData } from "../src/asked";
import OddOneOutPlugin from "../src/plugins/odd-one-out";
import { drawnStimulus, SHOWN } from "./drawn";

/** The middle of object 6, and a point of the background, on the page. */
const OBJECT_6 = { clientX: SHOWN.left + 2 * 30, clientY: SHOWN.top + 2 * 32 };
const BACKGROUND = { clientX: SHOWN.left + 2, clientY: SHOWN.top + 2 };

afterEach(() => {
  document.body.replaceChildren();
});

/** Run one trial, call `act` once the picture is visible, and return what jsPsych recorded. */
async function runTrial(
  act: (area: Element) => void | Promise<void>,
  parameters: { time_limit_s?: number } = {},
): Promise<TrialData> {
  const jsPsych = initJsPsych({ use_webaudio: false });
  const trial = {
    type: OddOneOutPlugin,
    stimuli: () => [drawnStimulus()],
    question: "Which one?",
    position: "Image 1 of 1",
    progress: 0,
    choices: 8,
    blank_s: 0.02,
    time_limit_s: null,
    ...parameters,
  };
  const run = jsPsych.run([trial]);
  const picture = await vi.waitUntil(() => document.querySelector(".picture:not(.hidden)"), {
    interval: 1,
  });
  // The answer is awaited from the frame after the picture's own.
  await new Promise((resolve) => setTimeout(resolve, 50));
  await act(picture.parentElement as Element);
  await run;
  return jsPsych.data.get().values()[0];
}

function press(area: Element, point: { clientX: number; clientY: number }, type = "mouse") {
  const init = { ...point, bubbles: true, isPrimary: true, pointerType: type };
  area.dispatchEvent(new PointerEvent("pointerdown", init));
  area.dispatchEvent(new PointerEvent("pointerup", init));
}

function key(code: string, key: string, more: KeyboardEventInit = {}) {
  document.dispatchEvent(new KeyboardEvent("keydown", { code, key, ...more }));
}

describe("odd-one-out", () => {
  it("records every field that it declares, and no other", async () => {
    const data = await runTrial((area) => press(area, OBJECT_6));
    const jsPsychsOwn = ["trial_type", "trial_index", "time_elapsed", "plugin_version"];
    const recorded = Object.keys(data).filter((name) => !jsPsychsOwn.includes(name));
    expect(recorded.sort()).toEqual(Object.keys(OddOneOutPlugin.info.data).sort());
  });

  it("takes the object under the pointer, and only an object", async () => {
    const data = await runTrial((area) => {
      press(area, BACKGROUND);
      press(area, OBJECT_6);
    });
    expect(data).toMatchObject({ answer: 6, input: "mouse" });
    expect(data.reaction_time_s).toBeGreaterThanOrEqual(0);
  });

  it("lets a press be taken back by releasing it elsewhere", async () => {
    const held = { bubbles: true, isPrimary: true };
    const data = await runTrial((area) => {
      area.dispatchEvent(new PointerEvent("pointerdown", { ...OBJECT_6, ...held }));
      area.dispatchEvent(new PointerEvent("pointerup", { ...BACKGROUND, ...held }));
      key("Digit2", "2");
    });
    expect(data).toMatchObject({ answer: 2, input: "keyboard" });
  });

  it("tells touch from mouse", async () => {
    const data = await runTrial((area) => press(area, OBJECT_6, "touch"));
    expect(data).toMatchObject({ answer: 6, input: "touch" });
  });

  it.each([
    ["Digit3", "3", 3],
    ["Digit8", "8", 8],
    ["Numpad5", "5", 5],
    ["Numpad1", "End", 1], // without Num Lock
    ["Digit1", "&", 1], // a French layout
    ["", "7", 7], // a virtual keyboard has no places
  ])("takes key %s (%s) as %i", async (code, name, answer) => {
    const data = await runTrial(() => key(code, name));
    expect(data).toMatchObject({ answer, input: "keyboard" });
  });

  it("passes over other keys, held keys and shortcuts", async () => {
    const data = await runTrial(() => {
      key("Digit9", "9");
      key("Digit0", "0");
      key("KeyA", "a");
      key("Digit3", "3", { repeat: true });
      key("Digit3", "3", { ctrlKey: true });
      key("Digit4", "4");
    });
    expect(data.answer).toBe(4);
  });

  it("takes a number button pressed without a pointer", async () => {
    const data = await runTrial((area) => {
      area.querySelectorAll<HTMLButtonElement>(".number")[4]?.click();
    });
    expect(data).toMatchObject({ answer: 5, input: "keyboard" });
  });

  it("ends without an answer at the time limit", async () => {
    const data = await runTrial(() => {}, { time_limit_s: 0.1 });
    expect(data).toMatchObject({ answer: null, reaction_time_s: null, input: "none" });
  });

  it("shows nothing of the picture during the blank", async () => {
    let seen = "";
    const watch = new MutationObserver(() => {
      const classes = document.querySelector(".picture")?.className;
      seen += classes === undefined ? "" : `${classes};`;
    });
    watch.observe(document.body, { childList: true, subtree: true });
    await runTrial(() => key("Digit1", "1"));
    watch.disconnect();
    expect(seen.split(";")[0]).toBe("picture hidden");
  });
});
