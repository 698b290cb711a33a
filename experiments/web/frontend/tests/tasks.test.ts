import { afterEach, describe, expect, it } from "vitest";
import { maskGreys } from "../src/mask";
import PickPlugin from "../src/plugins/pick";
import RankingPlugin from "../src/plugins/ranking";
import TwoAlternativePlugin from "../src/plugins/two-alternative";
import YesNoPlugin from "../src/plugins/yes-no";
import { drawnStimulus, plainStimulus } from "./drawn";
import { key, press, runTrial } from "./trial";

afterEach(() => {
  document.body.replaceChildren();
});

const all = (selector: string) => [...document.querySelectorAll<HTMLElement>(selector)];
const nth = (selector: string, index: number) => all(selector)[index] ?? null;
const images = (count: number) => () => Array.from({ length: count }, plainStimulus);

const PAIR = {
  type: TwoAlternativePlugin,
  stimuli: images(2),
  image_s: null,
  mask_s: null,
  seed: 1,
};
const JUDGED = { type: YesNoPlugin, stimuli: images(1), labels: ["Real", "Edited"], image_s: null };
const RANKED = { type: RankingPlugin, stimuli: images(4), ends: ["best", "worst"], ties: true };
const PICKED = {
  type: PickPlugin,
  stimuli: () => [drawnStimulus()],
  choices: 8,
  picks: [1, 2],
};
const SHOWN = ".picture:not(.hidden)";

describe.each([
  ["two-alternative", PAIR, "Digit1", TwoAlternativePlugin],
  ["yes-no", JUDGED, "Digit1", YesNoPlugin],
])("%s", (_, trial, code, plugin) => {
  it("records every field that it declares, and no other", async () => {
    const data = await runTrial(trial, SHOWN, () => key(code, "1"));
    const jsPsychsOwn = ["trial_type", "trial_index", "time_elapsed", "plugin_version"];
    const recorded = Object.keys(data).filter((name) => !jsPsychsOwn.includes(name));
    expect(recorded.sort()).toEqual(Object.keys(plugin.info.data).sort());
  });

  it("ends without an answer at the time limit", async () => {
    const data = await runTrial({ ...trial, time_limit_s: 0.1 }, SHOWN, () => {});
    expect(data).toMatchObject({ answer: null, reaction_time_s: null, input: "none" });
  });
});

describe("two-alternative", () => {
  it.each([
    ["a picture", () => press(nth(".picture", 1)), 2, "mouse"],
    ["a touch", () => press(nth(".picture", 0), "touch"), 1, "touch"],
    ["a button", () => press(nth(".answer", 1)), 2, "mouse"],
    ["a button without a pointer", () => nth(".answer", 0)?.click(), 1, "keyboard"],
    ["a digit", () => key("Digit2", "2"), 2, "keyboard"],
    ["an arrow", () => key("ArrowLeft", "ArrowLeft"), 1, "keyboard"],
  ])("takes %s", async (_, act, answer, input) => {
    const data = await runTrial(PAIR, SHOWN, act);
    expect(data).toMatchObject({ answer, input });
  });

  it("lets a press be taken back by releasing it on the other image", async () => {
    const data = await runTrial(PAIR, SHOWN, () => {
      press(nth(".picture", 0), "mouse", nth(".picture", 1));
      key("Digit3", "3");
      key("Digit2", "2");
    });
    expect(data).toMatchObject({ answer: 2, input: "keyboard" });
  });

  it("shows image, mask, image and mask in turn, and asks from the second image on", async () => {
    const seen: string[] = [];
    const watch = new MutationObserver(() => {
      const shown = all(".picture").flatMap((each, index) =>
        each.classList.contains("hidden") ? [] : [index],
      );
      const asked = document.querySelector<HTMLButtonElement>(".answer")?.disabled === false;
      const state = `${shown.join()}${asked ? "?" : ""}`;
      if (seen.at(-1) !== state) {
        seen.push(state);
      }
    });
    watch.observe(document.body, { subtree: true, attributes: true });
    const trial = { ...PAIR, image_s: 0.1, mask_s: 0.05 };
    await runTrial(trial, ".answer:not(:disabled)", async () => {
      await new Promise((resolve) => setTimeout(resolve, 250));
      key("Digit1", "1");
    });
    watch.disconnect();
    expect(seen).toEqual(["", "0", "1", "2", "2?", "3?", "?"]);
  });
});

describe("yes-no", () => {
  it.each([
    ["the first button", () => press(nth(".answer", 0)), 1],
    ["the second button", () => press(nth(".answer", 1)), 0],
    ["the key of the second", () => key("Numpad2", "2"), 0],
  ])("takes %s", async (_, act, answer) => {
    expect(await runTrial(JUDGED, SHOWN, act)).toMatchObject({ answer });
  });

  it("takes the answer after the image is gone", async () => {
    const data = await runTrial({ ...JUDGED, image_s: 0.06 }, SHOWN, async () => {
      await new Promise((resolve) => setTimeout(resolve, 120));
      expect(all(SHOWN)).toEqual([]);
      key("Digit1", "1");
    });
    expect(data.answer).toBe(1);
    expect(data.reaction_time_s).toBeGreaterThan(0.06);
  });
});

describe("ranking", () => {
  const done = () => nth("button.primary", 0)?.click();

  it("gives the order shown where nothing was moved", async () => {
    const data = await runTrial(RANKED, SHOWN, done);
    expect(data).toMatchObject({ answer: [1, 2, 3, 4], input: "keyboard" });
  });

  it("puts an image into the place of a digit, and moves a held one by arrows", async () => {
    const data = await runTrial(RANKED, SHOWN, () => {
      key("Digit1", "1", nth(".ranked", 3)); // 4th image first: 4 1 2 3
      const second = nth(".ranked", 2) as HTMLElement; // the 2nd image, now in place 3
      second.focus();
      key("Space", " ", second);
      expect(second.getAttribute("aria-pressed")).toBe("true");
      key("ArrowRight", "ArrowRight", second);
      expect(document.activeElement).toBe(second);
      done();
    });
    expect(data.answer).toEqual([2, 4, 3, 1]);
  });

  it("shares ranks where the study allows it", async () => {
    const data = await runTrial(RANKED, SHOWN, () => {
      nth(".tie", 0)?.click(); // places 1 and 2
      key("Equal", "=", nth(".ranked", 3)); // places 3 and 4
      expect(all(".rank").map((each) => each.textContent)).toEqual(["1", "1", "3", "3"]);
      done();
    });
    expect(data.answer).toEqual([1, 1, 3, 3]);
  });

  it("has no ties where the study forbids them", async () => {
    const data = await runTrial({ ...RANKED, ties: false }, SHOWN, () => {
      expect(all(".tie")).toEqual([]);
      key("Equal", "=", nth(".ranked", 3));
      done();
    });
    expect(data.answer).toEqual([1, 2, 3, 4]);
  });

  it("tells a screen reader what stands where", async () => {
    await runTrial(RANKED, SHOWN, () => {
      key("Digit1", "1", nth(".ranked", 3));
      expect(nth("[role=status]", 0)?.textContent).toBe("Image 4, rank 1 of 4");
      const labels = all(".ranked").map((each) => each.getAttribute("aria-label"));
      expect(labels[1]).toBe("Image 1, rank 2 of 4");
      done();
    });
  });
});

describe("pick", () => {
  const done = () => nth("button.primary", 0) as HTMLButtonElement;
  const held = () => all(".number[aria-pressed=true]").map((each) => each.textContent);

  it("takes picks back, and one too many in place of the last", async () => {
    const data = await runTrial(PICKED, SHOWN, async () => {
      expect(done().disabled).toBe(true);
      for (const [code, expected] of [
        ["5", "5"],
        ["5", ""],
        ["8", "8"],
        ["2", "2,8"],
        ["3", "3,8"],
      ] as const) {
        key(`Digit${code}`, code);
        await Promise.resolve();
        await Promise.resolve();
        expect(held().join()).toBe(expected);
        expect(all(".outline").length).toBe(held().length);
        expect(done().disabled).toBe(expected === "");
      }
      expect(nth("[role=status]", 0)?.textContent).toBe("Chosen: 3, 8");
      key("Enter", "Enter", nth(".number", 0)); // meant for that number, not for the button
      await Promise.resolve();
      press(done());
    });
    expect(data).toMatchObject({ answer: [3, 8], input: "mouse" });
  });

  it("ends without an answer at the time limit, whatever was picked before", async () => {
    const data = await runTrial({ ...PICKED, time_limit_s: 0.15 }, SHOWN, () => {
      key("Digit1", "1");
    });
    expect(data).toMatchObject({ answer: null, reaction_time_s: null, input: "none" });
  });
});

describe("masks", () => {
  it("are those of the lab", () => {
    // Another implementation: experiments/lab/mask.py.
    expect(maskGreys(6, 7)).toEqual([2, 15, 250, 178, 133, 103]);
  });
});
