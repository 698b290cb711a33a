import { initJsPsych } from "jspsych";
import { afterEach, describe, expect, it, vi } from "vitest";
import type { AnswerValue, Feedback } from "../src/api";
import FeedbackPlugin from "../src/plugins/feedback";
import { Stage } from "../src/stage";
import { drawnStimulus } from "./drawn";

afterEach(() => {
  document.body.replaceChildren();
});

function run(answer: number | null, feedback: Promise<Feedback | null>) {
  const jsPsych = initJsPsych({ use_webaudio: false });
  const trial = {
    type: FeedbackPlugin,
    exhibit: () => new Stage(drawnStimulus(), 8),
    name: (right: AnswerValue) => `number ${right}`,
    outcome: () => ({ answer, feedback }),
    question: "Which one?",
    position: "",
    progress: 0,
  };
  return jsPsych.run([trial]).then(() => jsPsych.data.get().values()[0].correct);
}

function button(): Promise<HTMLButtonElement> {
  return vi.waitUntil(() =>
    document.querySelector<HTMLButtonElement>("button.primary:not([hidden])"),
  );
}

describe("feedback", () => {
  it.each([
    [3, { correct: true, answer: 3 }, /Right.*3/],
    [2, { correct: false, answer: 3 }, /number 3/],
    [null, { correct: false, answer: 3 }, /Time is up.*3/],
  ])("tells %s of %o", async (answer, feedback, told) => {
    const done = run(answer, Promise.resolve(feedback));
    const go = await button();
    const status = document.querySelector("[role=status]");
    expect(status?.textContent).toMatch(told);
    expect(document.querySelectorAll(".outline path")).toHaveLength(2);
    go.click();
    expect(await done).toBe(feedback.correct);
  });

  it("tells nothing, and does not let go on, before the server's reply", async () => {
    let reply: (feedback: Feedback) => void = () => {};
    const done = run(3, new Promise((resolve) => (reply = resolve)));
    const status = await vi.waitUntil(() => document.querySelector("[role=status]"));
    expect(status.textContent).toMatch(/Waiting/);
    expect(document.querySelector<HTMLButtonElement>("button.primary")?.hidden).toBe(true);
    expect(document.querySelector(".outline")).toBeNull();
    reply({ correct: true, answer: 3 });
    (await button()).click();
    expect(await done).toBe(true);
  });

  it("goes on when the answer was refused", async () => {
    const done = run(3, Promise.reject(new Error("conflict")));
    (await button()).click();
    expect(await done).toBeNull();
  });
});
